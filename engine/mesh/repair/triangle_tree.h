// Distances of points from a surface.
#pragma once

#include "components/bvh_table.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// A surface that does not change, with a bounding volume tree over its triangles.
class TriangleTree {
public:
    /// The surface must have at least one triangle.
    explicit TriangleTree(SurfaceMesh surface);

    /// Exact squared distance from the point to the nearest triangle [m^2]. Returns `limit` if no triangle is nearer.
    Real distance_squared(const Vec3& point, Real limit = infinity) const;

private:
    void search(Index row, const Vec3& point, Real& nearest) const;

    SurfaceMesh surface_;
    BvhTable bvh_;
    BvhLeafTable leaves_;
};

}  // namespace skerry::mesh
