// Ray casts and nearest points on the present surface of one body or mesh (docs/methods/collision.md 10).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/bvh_table.h"
#include "components/range.h"

namespace skerry {

/// A ray: the points origin + t direction with t >= 0.
struct Ray {
    Vec3 origin;     // [m]
    Vec3 direction;  // unit vector
};

/// A surface and its bounding volume hierarchy. The boxes must have been computed from the present positions.
struct SurfaceTree {
    Range tree;  // rows of `node` and `box` that belong to this surface
    std::span<const BvhNode> node;
    std::span<const LeafTriangles> leaf_triangle;
    std::span<const Aabb> box;                            // [m]
    std::span<const std::array<Index, 3>> triangle_node;  // corners of each triangle: rows of `position`
    std::span<const Vec3> position;                       // [m]
};

struct TrianglePoint {
    Index triangle;  // row of `triangle_node`
    std::array<Real, 3> weight;
    Real distance;  // [m]
};

/// The first triangle that a ray hits from either side, at a distance of at most `limit` [m], which may be infinite. If
/// several triangles are equally near, the triangle with the lowest row is returned. The test is watertight: a ray
/// through an edge or corner of several triangles hits one of the triangles (Woop, Benthin and Wald 2013).
std::optional<TrianglePoint> cast_ray(const SurfaceTree& surface, const Ray& ray, Real limit);

/// The point of the surface that is nearest to `point`, if its distance is at most `limit` [m]. If several points are
/// equally near, the point on the triangle with the lowest row is returned.
std::optional<TrianglePoint> nearest_point(const SurfaceTree& surface, const Vec3& point, Real limit);

}  // namespace skerry
