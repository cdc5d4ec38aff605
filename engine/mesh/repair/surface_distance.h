// Distance between two surfaces.
#pragma once

#include <span>
#include <vector>

#include "skerry/fill.h"

namespace skerry::mesh {

/// Appends points of a regular lattice on a triangle to `points`, including the corners. Neighbouring points are at
/// most (longest edge / `intervals`) apart.
void sample_triangle(const std::array<Vec3, 3>& corner, int intervals, std::vector<Vec3>& points);

/// Measures the distance between two surfaces in both directions, because one direction alone misses a bump that the
/// other surface lacks. The distance of each sample point is exact; the sample points are a lattice on the triangles.
/// The spacing of this lattice is at most an eighth of the surface's mean edge. It is wider on edges longer than eight
/// mean edges, which have 64 intervals, and on surfaces of more than 90,000 triangles, which have about 3 million
/// points. Between the points the distance may be larger by at most this spacing. Each surface needs at least one
/// triangle.
SurfaceDistance surface_distance(const SurfaceMesh& first, const SurfaceMesh& second);

}  // namespace skerry::mesh
