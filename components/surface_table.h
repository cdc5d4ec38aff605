// The surfaces of the bodies: triangles, edges and vertices.
#pragma once

#include <array>
#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

/// Boundary triangles with their corners counter-clockwise as seen from outside. A vertex or edge of several triangles
/// is owned by the one with the lowest row. A search that compares two triangles compares only features that they own,
/// and so finds each pair of features once.
///
/// A round body has one degenerate triangle, its core. A side that is not an edge has the entry no_index in `edge`.
/// - sphere, cylinder: all three corners are the centre
/// - capsule: corner 0 is one end of the axis, corners 1 and 2 are the other end; the only edge is the axis, from
///   corner 0 to corner 1
struct TriangleTable {
    Column<std::array<Index, 3>> node;    // rows of NodeTable
    Column<std::array<Index, 3>> edge;    // rows of EdgeTable; edge k connects corner k and corner (k + 1) % 3
    Column<std::array<Index, 3>> vertex;  // rows of VertexTable
    Column<std::uint8_t> owned_vertices;  // bit k: this triangle owns vertex k
    Column<std::uint8_t> owned_edges;     // bit k: this triangle owns edge k
    // Number e of the tetrahedron that the triangle is a face of: lane e % 8 of block e / 8 of TetrahedronBlockTable;
    // or no_index.
    Column<Index> element;

    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::derived);
        visit("edge", edge, ColumnRole::derived);
        visit("vertex", vertex, ColumnRole::derived);
        visit("owned_vertices", owned_vertices, ColumnRole::derived);
        visit("owned_edges", owned_edges, ColumnRole::derived);
        visit("element", element, ColumnRole::derived);
    }
};

/// True if a triangle is the core of a round body.
inline bool is_core(const std::array<Index, 3>& node) {
    return node[1] == node[2];
}

struct EdgeTable {
    Column<std::array<Index, 2>> node;  // rows of NodeTable, the lower row first
    // Rows of TriangleTable: the triangles at the edge. The second row is no_index on an open boundary and for a core.
    Column<std::array<Index, 2>> triangle;

    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::derived);
        visit("triangle", triangle, ColumnRole::derived);
    }
};

struct VertexTable {
    Column<Index> node;  // row of NodeTable
    // The triangles around the vertex are rows triangle_begin .. triangle_end - 1 of SurfaceTables::vertex_triangle.
    Column<Index> triangle_begin;
    Column<Index> triangle_end;

    void for_each_column(auto&& visit) {
        visit("node", node, ColumnRole::derived);
        visit("triangle_begin", triangle_begin, ColumnRole::derived);
        visit("triangle_end", triangle_end, ColumnRole::derived);
    }
};

/// Triangles, edges and vertices of all bodies, and the list of triangles around each vertex. Model::rebuild_outlines
/// derives the columns.
struct SurfaceTables {
    TriangleTable triangles;
    EdgeTable edges;
    VertexTable vertices;
    Column<Index> vertex_triangle;  // rows of TriangleTable, listed vertex by vertex

    void for_each_column(auto&& visit) {
        triangles.for_each_column(visit);
        edges.for_each_column(visit);
        vertices.for_each_column(visit);
        visit("vertex_triangle", vertex_triangle, ColumnRole::derived);
    }
};

}  // namespace skerry
