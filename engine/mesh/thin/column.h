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

/// Tetrahedra that a ray crosses between two opposite boundary triangles. The ray starts at the centroid of the first
/// triangle and follows its inner normal.
struct ThinColumn {
    std::array<Index, 3> first, last;  // nodes of the two boundary triangles, each in ascending order
    Vec3 start, direction;             // centroid [m], and unit vector
    Real area;                         // area of the first triangle [m^2]
    std::vector<Crossing> crossings;
    // thickness divided by the mean extent of the crossed tetrahedra along the ray: about the number of layers of cells
    Real layers;

    Real thickness() const { return crossings.back().end; }
};

/// Returns a column for each boundary triangle under which the mesh is thin: at most twice as thick as the edges of
/// the crossed tetrahedra are long on average.
std::vector<ThinColumn> thin_columns(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary);

}  // namespace skerry::mesh
