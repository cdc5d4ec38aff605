// Distances of points from a surface.
#pragma once

#include <limits>

#include "components/bvh_table.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// A constant surface, with a tree over its triangles.
class TriangleTree {
public:
    /// The surface must have at least one triangle.
    explicit TriangleTree(SurfaceMesh surface);

    /// Exact squared distance to the nearest triangle, or `limit` if none is nearer than that [m^2].
    Real distance_squared(const Vec3& point, Real limit = std::numeric_limits<Real>::infinity()) const;

private:
    void search(Index row, const Vec3& point, Real& nearest) const;

    SurfaceMesh surface_;
    BvhTable bvh_;
    BvhLeafTable leaves_;
};

}  // namespace skerry::mesh
