// Surfaces of bodies as films and glTF files draw them: vertices, values at the vertices, and colours.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/output/collect_frame.h"
#include "engine/output/frame.h"
#include "engine/output/page/quantile.h"
#include "skerry/output.h"

namespace skerry {

/// Vertices and triangles of the drawn surface of a body: its visual surface, or its boundary if it has none.
class DrawnSurface {
public:
    explicit DrawnSurface(const BodyFrame& body);

    /// True if `body`, a later frame of the same body, has the same drawn surface.
    bool is_drawn(const BodyFrame& body) const;
    /// Corners as vertex numbers, counter-clockwise as seen from outside.
    const std::vector<std::array<Index, 3>>& triangles() const { return triangles_; }
    /// Positions or velocities of the vertices, given those of the nodes of `body`.
    std::vector<Vec3> vectors(const BodyFrame& body, std::span<const Vec3> of_nodes) const;
    /// Values of a quantity at the vertices, given those at the nodes of `body`.
    std::vector<Real> values(const BodyFrame& body, std::span<const Real> of_nodes, FilmColor color) const;

private:
    const BoundVisual* visual_;  // visual surface in the first frame, only for comparison
    std::vector<Index> node_;    // node of the body at each vertex if there is no visual surface
    std::vector<std::array<Index, 3>> triangles_;
};

/// Throws SceneError that names the file and the setting, unless the value of the setting is a positive number.
void require_positive(const std::filesystem::path& file, const char* setting, Real value);

using Vec3f = std::array<float, 3>;

/// Converts points to floats relative to an origin, so that they are exact at any distance of the body from the origin
/// of the world.
std::vector<Vec3f> relative_to(const Vec3& origin, std::span<const Vec3> points);
Vec3 mean_of(std::span<const Vec3> points);

/// Name of the vertex attribute that colours show, and its unit.
struct Quantity {
    const char *name, *unit;
};
/// Not for FilmColor::none.
Quantity quantity_of(FilmColor color);
/// Values of this quantity by body of the frame and by node. Not for FilmColor::none.
std::vector<std::vector<Real>> quantity_of_nodes(const Frame& frame, FilmColor color);
/// Value at the upper end of the colours, unless the user gives one: 99 % of the values above zero are below it.
inline Real usual_top(const Quantile& values) {
    return values.at(0.99);
}

/// Red, green and blue, linear.
using Color = Vec3f;
/// Colour of a value. The colours belong to values from 0 to `top`.
Color color_of_value(Real value, Real top);
/// Content that a frame needs for the colours.
inline FrameContent content_of(FilmColor color) {
    return color == FilmColor::stress ? FrameContent::node_fields : FrameContent::motion;
}

/// Colour of a body by its number, for FilmColor::none.
Color color_of_body(std::size_t number);
Color color_of_colliders();
Color color_of_material(const VisualMaterial& material);

/// Throws SceneError if this library was built without glTF.
void require_gltf();

}  // namespace skerry
