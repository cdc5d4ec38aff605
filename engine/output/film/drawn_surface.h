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

    /// True if `body`, a later frame of the body given to the constructor, still has the same visual surface or still
    /// has none, so that this object can draw it.
    bool is_drawn(const BodyFrame& body) const;
    /// Corners as vertex numbers, counter-clockwise as seen from outside.
    const std::vector<std::array<Index, 3>>& triangles() const { return triangles_; }
    /// Positions (or velocities) of the vertices, given the positions (or velocities) `of_nodes` of the nodes of
    /// `body`.
    std::vector<Vec3> vectors(const BodyFrame& body, std::span<const Vec3> of_nodes) const;
    /// Values of the quantity `color` at the vertices, given its values `of_nodes` at the nodes of `body`.
    std::vector<Real> values(const BodyFrame& body, std::span<const Real> of_nodes, FilmColor color) const;

private:
    const BoundVisual* visual_;  // visual surface in the first frame; nullptr: the boundary is drawn
    std::vector<Index> node_;    // without a visual surface: node of the body at each vertex
    std::vector<std::array<Index, 3>> triangles_;
};

/// Throws SceneError that names the file and the setting, unless the value of the setting is a positive number.
void require_positive(const std::filesystem::path& file, const char* setting, Real value);

using Vec3f = std::array<float, 3>;

/// Subtracts `origin` from the points before converting them to floats, so that rounding errors do not grow with the
/// distance of a body from the origin of the world.
std::vector<Vec3f> relative_to(const Vec3& origin, std::span<const Vec3> points);
Vec3 mean_of(std::span<const Vec3> points);

/// Name and unit of the quantity that colours show. The vertex attribute that holds its values has the same name.
struct Quantity {
    const char *name, *unit;
};
/// Not for FilmColor::none.
Quantity quantity_of(FilmColor color);
/// Values of the quantity that `color` shows, for each body of the frame and each of its nodes. `color` must not be
/// FilmColor::none.
std::vector<std::vector<Real>> quantity_of_nodes(const Frame& frame, FilmColor color);
/// Default of the value at the upper end of the colours: 99 % of the positive values are below it.
inline Real usual_top(const Quantile& values) {
    return values.at(0.99);
}

/// Linear intensities of red, green and blue, from 0 to 1.
using Color = Vec3f;
/// Colour of a value. The colour ramp extends from 0 to `top`.
Color color_of_value(Real value, Real top);
/// Content with which a frame must be collected for the colours.
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
