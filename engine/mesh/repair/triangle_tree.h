// How far points are from a surface.
#pragma once

#include <limits>

#include "components/bvh_table.h"
#include "skerry/mesh.h"

namespace skerry::mesh {

/// A surface that stays as it is, and a tree over its triangles.
class TriangleTree {
public:
    /// At least one triangle.
    explicit TriangleTree(SurfaceMesh surface);

    /// m^2, to the nearest triangle, exact; `limit` (m^2) when nothing is nearer than that.
    Real distance_squared(const Vec3& point, Real limit = std::numeric_limits<Real>::infinity()) const;

private:
    void search(Index row, const Vec3& point, Real& nearest) const;

    SurfaceMesh surface_;
    BvhTable bvh_;
    BvhLeafTable leaves_;
};

}  // namespace skerry::mesh
