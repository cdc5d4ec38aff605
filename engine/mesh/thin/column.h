// Columns of tetrahedra through thin parts of a mesh.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Part of a ray that lies in one tetrahedron.
struct Crossing {
    Index tetrahedron;
    Real begin, end;  // distances from the start of the ray [m]
};

/// The tetrahedra along a ray through a thin part. The ray starts at the centroid of a boundary triangle (`first`),
/// follows its inner normal, and leaves through the boundary triangle `last`.
struct ThinColumn {
    std::array<Index, 3> first, last;  // nodes of the triangles of entry and exit, each in ascending order
    Vec3 start, direction;             // start of the ray [m], and its unit vector
    Real area;                         // area of the first triangle [m^2]
    std::vector<Crossing> crossings;
    // number of layers of cells, approximately: thickness divided by the mean extent of the crossed tetrahedra along
    // the ray
    Real layers;

    Real thickness() const { return crossings.back().end; }
};

/// Returns a column for each boundary triangle under which the mesh is thin: its thickness is at most twice the mean
/// edge length of the crossed tetrahedra, and the ray leaves nearly normal to the last triangle.
std::vector<ThinColumn> thin_columns(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary);

}  // namespace skerry::mesh
