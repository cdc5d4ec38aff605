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
    std::uint8_t corner;  // the corner opposite of the face
    bool turned;          // true if its nodes are clockwise as seen from outside
};
/// Faces of all tetrahedra, sorted by their nodes. Faces with the same nodes are in the order of the tetrahedra.
std::vector<TetrahedronFace> sorted_faces(std::span<const std::array<Index, 4>> tetrahedra);

/// The boundary triangles of a tetrahedral mesh (faces of exactly one tetrahedron), counter-clockwise seen from
/// outside, in element order.
struct BoundaryTriangle {
    std::array<Index, 3> node;  // local numbers
    Index element;              // local number
};
std::vector<BoundaryTriangle> boundary_triangles(std::span<const std::array<Index, 4>> tetrahedra);

struct SurfaceRanges {
    Range triangles, edges, vertices;
};

/// Appends the triangles, edges and vertices of a new body. Triangle nodes and elements are local; `first_node` and
/// `first_element` are the rows of local number 0 (first_element is no_index for a surface without elements).
SurfaceRanges append_surface(std::span<const BoundaryTriangle> triangles, Index first_node, Index first_element,
                             SurfaceTables& surface);

/// Appends the surface of a body with the same mesh as an earlier one, whose rows are `like`; the result equals that of
/// append_surface. Stores in `behind` the row offsets of the new surface from the earlier one.
SurfaceRanges append_surface_again(const SurfaceRanges& like, RowsBehind& behind, SurfaceTables& surface);

}  // namespace skerry
