// Meshes of bodies of revolution, built as a stack of discs.
#pragma once

#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// A disc about the z axis, triangulated by a centre and `rings` equally spaced rings; ring k has 6 k nodes. The
/// triangles are nearly equilateral. A disc with 0 rings is a single node at its centre.
struct Disc {
    Real z;       // [m]
    Real radius;  // [m]
    int rings;
};

/// Fills the spaces between neighbouring discs with tetrahedra. The z coordinates of the discs must ascend.
/// Neighbouring discs may differ by at most one ring and must not both be points.
Mesh stack_discs(const std::vector<Disc>& discs);

}  // namespace skerry::mesh
