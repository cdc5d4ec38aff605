// Bounding volume hierarchies of all bodies, body after body.
#pragma once

#include <array>
#include <cstddef>

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

/// Axis-aligned box.
struct Aabb {
    Vec3 lower;  // [m]
    Vec3 upper;  // [m]
};

/// A node of a tree whose nodes are stored in depth-first order. The left child of row i is row i + 1. `skip` is the
/// row after the last descendant of the node.
struct BvhNode {
    Index skip;
    Index right;  // row of the right child; no_index for a leaf
    Index leaf;   // row of BvhLeafTable; no_index for an inner node
    Index count;  // number of triangles of a leaf, stored in the first lanes of its LeafTriangles; 0 for an inner node
};

inline constexpr int leaf_lanes = 8;

/// Triangles of a leaf: rows of TriangleTable; unused lanes are no_index.
using LeafTriangles = std::array<Index, leaf_lanes>;

/// Mesh nodes of the triangles of a leaf, copied from TriangleTable. Computing the box of a leaf and gathering its
/// triangles then need not read TriangleTable.
struct LeafNodes {
    static constexpr std::size_t capacity = 3 * leaf_lanes;
    // Mesh nodes of the three corners of each triangle, by lane; lanes without a triangle repeat the first triangle.
    std::array<std::array<Index, leaf_lanes>, 3> corner;
    Index count = 0;
    std::array<Index, capacity> node{};  // the mesh nodes of all triangles of the leaf, ascending, each listed once
};

/// Edges and vertices that the triangles of a leaf own; each edge or vertex has one owner (TriangleTable). A search
/// reads this copy instead of TriangleTable.
struct LeafFeatures {
    static constexpr std::size_t capacity = 3 * leaf_lanes;
    struct Edge {
        Index row;  // row of EdgeTable
        std::array<Index, 2> node;
    };
    struct Point {
        Index row;  // row of VertexTable
        Index node;
    };
    Index edge_count = 0, point_count = 0;
    std::array<Edge, capacity> edge{};
    std::array<Point, capacity> point{};
};

/// Boxes and topology of the tree nodes. Model::rebuild_outlines derives BvhTable and BvhLeafTable.
struct BvhTable {
    Column<Aabb> box;      // box of the tree node [m]; out of date until it is computed again before a use of the tree
    Column<BvhNode> node;  // topology of the tree, which is built once from the rest shape

    void for_each_column(auto&& visit) {
        visit("box", box, ColumnRole::scratch);
        visit("node", node, ColumnRole::derived);
    }
};

struct BvhLeafTable {
    Column<LeafTriangles> triangle;
    Column<LeafNodes> nodes;
    Column<LeafFeatures> features;

    void for_each_column(auto&& visit) {
        visit("triangle", triangle, ColumnRole::derived);
        visit("nodes", nodes, ColumnRole::derived);
        visit("features", features, ColumnRole::derived);
    }
};

}  // namespace skerry
