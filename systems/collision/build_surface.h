// Computes the surface of a new body: boundary triangles, edges and vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "components/append_copies.h"
#include "components/body_table.h"
#include "components/surface_table.h"

namespace skerry {

struct TetrahedronFace {
    std::array<Index, 3> node;  // ascending
    Index tetrahedron;
    std::uint8_t corner;  // corner of the tetrahedron opposite to the face, 0 to 3
    bool turned;          // true: the nodes in ascending order are clockwise as seen from outside
};
/// Returns the faces of all tetrahedra, sorted by their nodes. Faces with the same nodes are sorted by tetrahedron.
std::vector<TetrahedronFace> sorted_faces(std::span<const std::array<Index, 4>> tetrahedra);

/// A boundary triangle of a tetrahedral mesh: a face that belongs to exactly one tetrahedron. Its nodes are
/// counter-clockwise as seen from outside. boundary_triangles returns the triangles in the order of their tetrahedra.
struct BoundaryTriangle {
    std::array<Index, 3> node;  // node numbers within the body
    Index element;              // number of the tetrahedron within the body
};
std::vector<BoundaryTriangle> boundary_triangles(std::span<const std::array<Index, 4>> tetrahedra);

struct SurfaceRanges {
    Range triangles, edges, vertices;
};

/// Appends the triangles, edges and vertices of the surface of a new body to `surface`. Returns the ranges of the new
/// rows. The node and element numbers in `triangles` are local to the body. `first_node` and `first_element` are the
/// table rows of node 0 and element 0 of the body. For a surface without elements, `first_element` is no_index.
SurfaceRanges append_surface(std::span<const BoundaryTriangle> triangles, Index first_node, Index first_element,
                             SurfaceTables& surface);

/// Appends the surface of a new body as a copy of the surface of an earlier body with the same mesh. Returns the ranges
/// of the new rows. `original`: ranges of the earlier surface. `offset`: row numbers of the new body minus those of the
/// earlier body; the caller sets them for nodes and elements, the function for triangles, edges and vertices.
SurfaceRanges append_surface_copy(const SurfaceRanges& original, RowOffsets& offset, SurfaceTables& surface);

}  // namespace skerry
