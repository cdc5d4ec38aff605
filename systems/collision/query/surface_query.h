// Rays and nearest points on the present surface of one body or mesh (docs/methods/collision.md 10).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/bvh_table.h"
#include "components/range.h"

namespace skerry {

/// The points origin + t direction with t >= 0.
struct Ray {
    Vec3 origin;     // [m]
    Vec3 direction;  // unit
};

/// A surface and its tree, whose boxes are fitted around the present positions.
struct SurfaceTree {
    Range tree;  // rows of `node` and `box`
    std::span<const BvhNode> node;
    std::span<const LeafTriangles> leaf_triangle;
    std::span<const Aabb> box;                            // [m]
    std::span<const std::array<Index, 3>> triangle_node;  // rows of `position`
    std::span<const Vec3> position;                       // [m]
};

struct TrianglePoint {
    Index triangle;  // row of `triangle_node`
    std::array<Real, 3> weight;
    Real distance;  // [m]
};

/// The first triangle that the ray meets at no more than `limit` [m] (may be infinite), from either side. Among equally
/// near ones it is the lowest row. The test is watertight: a ray that meets an edge or a corner of several triangles
/// meets one of them (Woop, Benthin and Wald 2013).
std::optional<TrianglePoint> cast_ray(const SurfaceTree& surface, const Ray& ray, Real limit);

/// The nearest point of the surface within `limit` [m]; among equally near ones that of the lowest row.
std::optional<TrianglePoint> nearest_point(const SurfaceTree& surface, const Vec3& point, Real limit);

}  // namespace skerry
