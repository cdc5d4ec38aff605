// Ray casts and nearest points on the present surface of one body or mesh (docs/methods/collision.md 10).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/bvh_table.h"
#include "components/range.h"

namespace skerry {

/// The points origin + t direction of a ray, with t >= 0.
struct Ray {
    Vec3 origin;     // [m]
    Vec3 direction;  // unit
};

/// A surface and its bounding volume hierarchy, whose boxes fit the present positions.
struct SurfaceTree {
    Range tree;  // rows of `node` and `box` of this surface
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

/// The first triangle that a ray hits from either side, at a distance of at most `limit` [m], which may be infinite.
/// Among equally near triangles, it is the one with the lowest row. The test is watertight: a ray through an edge or
/// corner of several triangles hits one of them (Woop, Benthin and Wald 2013).
std::optional<TrianglePoint> cast_ray(const SurfaceTree& surface, const Ray& ray, Real limit);

/// The point of the surface nearest to `point` within a distance of `limit` [m]. Among equally near points, it is the
/// one on the triangle with the lowest row.
std::optional<TrianglePoint> nearest_point(const SurfaceTree& surface, const Vec3& point, Real limit);

}  // namespace skerry
