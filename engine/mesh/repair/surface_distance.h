// Distance between two surfaces.
#pragma once

#include <span>
#include <vector>

#include "skerry/fill.h"

namespace skerry::mesh {

/// Appends points of a regular lattice on a triangle to `points`, including the corners. The spacing of the lattice is
/// at most the longest edge of the triangle divided by `intervals`.
void sample_triangle(const std::array<Vec3, 3>& corner, int intervals, std::vector<Vec3>& points);

/// Measures the distance from each surface to the other one at sample points, exactly. Both directions are needed: the
/// distance from one surface misses a bump that only the other surface has. Each surface needs at least one triangle.
///
/// The sample points form a lattice on each triangle. Between them the distance may be larger, by at most the spacing
/// of the lattice. This spacing is usually at most an eighth of the mean edge of the surface, but larger
/// - where an edge would need more than 64 intervals,
/// - on surfaces of more than 90,000 triangles, which get about 3 million points.
SurfaceDistance surface_distance(const SurfaceMesh& first, const SurfaceMesh& second);

}  // namespace skerry::mesh
