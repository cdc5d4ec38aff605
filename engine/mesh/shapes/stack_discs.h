// Bodies of revolution as a stack of discs.
#pragma once

#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// A disc about the z axis, triangulated by a centre and `rings` rings at equal distances, the k-th of 6 k nodes:
/// nearly equilateral triangles all over. No rings: a point.
struct Disc {
    Real z;       // m
    Real radius;  // m
    int rings;
};

/// Fills the space between neighbouring discs. z ascends, neighbours differ by one ring at most and are not both
/// points.
Mesh stack_discs(const std::vector<Disc>& discs);

}  // namespace skerry::mesh
