// Edge lengths, area, volume and extent of triangle surfaces.
#pragma once

#include <array>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Positions of the corners of a triangle, given by its nodes or by its index in surface.triangles [m].
std::array<Vec3, 3> corners(const SurfaceMesh& surface, const std::array<Index, 3>& triangle);
inline std::array<Vec3, 3> corners_of(const SurfaceMesh& surface, Index triangle) {
    return corners(surface, surface.triangles[static_cast<std::size_t>(triangle)]);
}

/// Mean length of the edges of all triangles [m]. The surface needs at least one triangle.
Real mean_edge(const SurfaceMesh& surface);

/// Area [m^2].
Real area_of(const SurfaceMesh& surface);

/// Volume inside a closed surface by the divergence theorem [m^3]. It is negative if the triangles are clockwise as
/// seen from outside. Positions are measured from a point of the surface, so that the rounding error does not grow with
/// the distance from the origin.
Real volume_inside(const SurfaceMesh& surface);

/// Length of the diagonal of the bounding box of the nodes [m].
Real box_diagonal(const SurfaceMesh& surface);

}  // namespace skerry::mesh
