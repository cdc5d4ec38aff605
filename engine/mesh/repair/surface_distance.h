// How far two surfaces are apart.
#pragma once

#include <span>
#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Appends points of a triangle, corners among them, no two neighbours further apart than the longest edge over
/// `parts`.
void sample_triangle(const std::array<Vec3, 3>& corner, int parts, std::vector<Vec3>& points);

/// Greatest distances (m) of points of one surface to the nearest point of the other.
struct SurfaceDistance {
    Real from_first = 0, from_second = 0;

    Real greatest() const { return from_first > from_second ? from_first : from_second; }
};

/// Both ways: one alone does not see a bump that the other surface lacks. Distances are exact, the points a lattice on
/// every triangle, no coarser than an eighth of the mean edge of its surface: between them a surface may be further
/// away by at most that. Each surface has at least one triangle.
SurfaceDistance surface_distance(const SurfaceMesh& first, const SurfaceMesh& second);

}  // namespace skerry::mesh
