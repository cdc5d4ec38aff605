// Boundary of a new body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/surface_table.h"

namespace skerry {

/// The boundary triangles of a tetrahedral mesh (faces of exactly one tetrahedron), counter-clockwise seen from
/// outside, in element order.
struct BoundaryTriangle {
    std::array<Index, 3> node;  // local
    Index element;              // local
};
std::vector<BoundaryTriangle> boundary_triangles(std::span<const std::array<Index, 4>> tetrahedra);

struct SurfaceRanges {
    Range triangles, edges, vertices;
};

/// Appends the triangles, edges and vertices of a new body. Triangle nodes and elements are local; `first_node` and
/// `first_element` are the rows that local 0 stands for (first_element may be no_index: a surface without elements).
SurfaceRanges append_surface(std::span<const BoundaryTriangle> triangles, Index first_node, Index first_element,
                             SurfaceTables& surface);

}  // namespace skerry
