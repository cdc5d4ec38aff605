// Bodies of revolution as a stack of discs.
#pragma once

#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// A disc about the z axis, triangulated by a centre and `rings` equally spaced rings; ring k has 6 k nodes. The
/// triangles are nearly equilateral. Without rings it is a point.
struct Disc {
    Real z;       // [m]
    Real radius;  // [m]
    int rings;
};

/// Fills the space between neighbouring discs. z must ascend. Neighbours may differ by one ring at most and must not
/// both be points.
Mesh stack_discs(const std::vector<Disc>& discs);

}  // namespace skerry::mesh
