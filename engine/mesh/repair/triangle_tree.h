// Distances of points from a surface.
#pragma once

#include <array>

#include "components/bvh_table.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// The triangle that is nearest to a point, and the nearest point of this triangle.
struct NearestTriangle {
    Index triangle = no_index;
    std::array<Real, 3> weight{};      // barycentric weights of the nearest point
    Real distance_squared = infinity;  // [m^2]
};

/// A copy of a surface, with a bounding volume hierarchy over its triangles.
class TriangleTree {
public:
    /// The surface must have at least one triangle.
    explicit TriangleTree(SurfaceMesh surface);

    /// Exact squared distance from the point to the nearest triangle [m^2]. `limit`: upper limit of the squared
    /// distance; it is returned if no triangle is nearer [m^2].
    Real distance_squared(const Vec3& point, Real limit = infinity) const {
        return nearest(point, limit).distance_squared;
    }
    /// Nearest triangle. `limit`: upper limit of the squared distance [m^2]. If no triangle is nearer than this limit,
    /// `triangle` is no_index and `distance_squared` is `limit`.
    NearestTriangle nearest(const Vec3& point, Real limit = infinity) const;
    /// Nearest triangle among those whose normal is within 90 degrees of `facing` and points to the side on which the
    /// point lies. `limit`: see nearest().
    NearestTriangle nearest_facing(const Vec3& point, const Vec3& facing, Real limit) const;

private:
    /// Searches the subtree below node `row` of bvh_ for a triangle nearer than `nearest`. If there is one, the nearest
    /// of them replaces `nearest`. `facing`: see nearest_facing; nullptr: all triangles are searched.
    void search(Index row, const Vec3& point, const Vec3* facing, NearestTriangle& nearest) const;
    bool faces(Index triangle, const Vec3& point, const Vec3& facing) const;

    SurfaceMesh surface_;
    BvhTable bvh_;
    BvhLeafTable leaves_;
};

}  // namespace skerry::mesh
