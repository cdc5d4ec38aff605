// Surfaces of bodies as films and glTF files draw them: vertices, values at the vertices, and colours.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/quantile.h"
#include "skerry/output.h"

namespace skerry {

/// Vertices and triangles of the drawn surface of a body.
class DrawnSurface {
public:
    explicit DrawnSurface(const BodyFrame& body);

    /// Corners as vertex numbers, counter-clockwise as seen from outside.
    const std::vector<std::array<Index, 3>>& triangles() const { return triangles_; }
    /// Values at the vertices, given those at the nodes of the body.
    template <class T>
    std::vector<T> at_vertices(std::span<const T> of_nodes) const {
        std::vector<T> values;
        values.reserve(node_.size());
        for (const Index node : node_) values.push_back(of_nodes[static_cast<std::size_t>(node)]);
        return values;
    }

private:
    std::vector<Index> node_;  // node of the body at each vertex
    std::vector<std::array<Index, 3>> triangles_;
};

using Vec3f = std::array<float, 3>;

/// Converts points to floats relative to an origin, so that they are exact however far the body is from the origin of
/// the world.
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
/// Colour of a body by its number, for FilmColor::none.
Color color_of_body(std::size_t number);
Color color_of_colliders();

}  // namespace skerry
