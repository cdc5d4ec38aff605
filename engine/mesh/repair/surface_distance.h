// Distance between two surfaces.
#pragma once

#include <span>
#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Appends lattice points of a triangle, including its corners. Neighbours are at most (longest edge / `parts`) apart.
void sample_triangle(const std::array<Vec3, 3>& corner, int parts, std::vector<Vec3>& points);

/// Largest distances of points of one surface to the nearest point of the other [m].
struct SurfaceDistance {
    Real from_first = 0, from_second = 0;

    Real greatest() const { return from_first > from_second ? from_first : from_second; }
};

/// Measures both ways: one way alone misses a bump that the other surface lacks. Distances are exact, but evaluated on
/// a lattice of points. Their spacing is at most an eighth of the surface's mean edge, except that an edge has at most
/// 64 intervals. Between the points the distance may be larger by at most that spacing. Each surface needs at least
/// one triangle.
SurfaceDistance surface_distance(const SurfaceMesh& first, const SurfaceMesh& second);

}  // namespace skerry::mesh
