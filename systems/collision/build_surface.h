// Boundary of a new body.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "components/append_again.h"
#include "components/body_table.h"
#include "components/surface_table.h"

namespace skerry {

/// A face of a tetrahedron.
struct TetrahedronFace {
    std::array<Index, 3> node;  // ascending
    Index tetrahedron;
    std::uint8_t corner;  // the one it lies opposite of
    bool turned;          // seen from outside its nodes come clockwise
};
/// Those of all tetrahedra by their nodes; those with the same nodes in the order of the tetrahedra.
std::vector<TetrahedronFace> sorted_faces(std::span<const std::array<Index, 4>> tetrahedra);

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

/// The same as append_surface of a body whose mesh is that of an earlier one with the rows `like`. Adds to `behind` how
/// far it lies behind that one on the surface.
SurfaceRanges append_surface_again(const SurfaceRanges& like, RowsBehind& behind, SurfaceTables& surface);

}  // namespace skerry
