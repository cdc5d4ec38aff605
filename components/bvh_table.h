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

/// A node of a tree that is stored in depth-first order. The left child of row i is row i + 1. `skip` is the row behind
/// the last descendant.
struct BvhNode {
    Index skip;
    Index right;  // row of the right child; no_index in a leaf
    Index leaf;   // row of BvhLeafTable; no_index in an inner node
    Index count;  // number of triangles in a leaf, which are the first lanes of its row; 0 in an inner node
};

inline constexpr int leaf_lanes = 8;

/// Triangles of a leaf: rows of TriangleTable, no_index in unused lanes.
using LeafTriangles = std::array<Index, leaf_lanes>;

/// Nodes of the triangles of a leaf, stored together, so that fitting or gathering a leaf does not read TriangleTable.
struct LeafNodes {
    static constexpr std::size_t most = 3 * leaf_lanes;
    // Nodes of corners, by lane; lanes without a triangle repeat the first triangle.
    std::array<std::array<Index, leaf_lanes>, 3> corner;
    Index count = 0;
    std::array<Index, most> node{};  // without duplicates, ascending
};

/// Edges and vertices that the triangles of a leaf own, stored together, so that a search does not read TriangleTable.
struct LeafFeatures {
    static constexpr std::size_t most = 3 * leaf_lanes;
    struct Edge {
        Index row;  // of EdgeTable
        std::array<Index, 2> node;
    };
    struct Point {
        Index row;  // of VertexTable
        Index node;
    };
    Index edge_count = 0, point_count = 0;
    std::array<Edge, most> edge{};
    std::array<Point, most> point{};
};

/// Box and topology of each tree node. Model::rebuild_outlines derives BvhTable and BvhLeafTable.
struct BvhTable {
    Column<Aabb> box;      // box of the tree node; refitted when a pair of its body is searched again [m]
    Column<BvhNode> node;  // topology of the tree, built once from the rest shape

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
