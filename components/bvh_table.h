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

/// A node of a tree stored in depth-first order: the left child of row i is i + 1, and `skip` is one past its last
/// descendant.
struct BvhNode {
    Index skip;
    Index right;  // row of the right child; no_index in a leaf
    Index leaf;   // row of BvhLeafTable; no_index in an inner node
    Index count;  // triangles of a leaf, the first lanes of its row; 0 in an inner node
};

inline constexpr int leaf_lanes = 8;

/// The triangles of a leaf, rows of TriangleTable; no_index in lanes without one.
using LeafTriangles = std::array<Index, leaf_lanes>;

/// The nodes of the triangles of a leaf, stored together: fitting or gathering a leaf does not read TriangleTable.
struct LeafNodes {
    static constexpr std::size_t most = 3 * leaf_lanes;
    std::array<std::array<Index, leaf_lanes>, 3> corner;  // by lane; lanes without a triangle repeat the first
    Index count = 0;
    std::array<Index, most> node{};  // without duplicates, ascending
};

/// The edges and vertices that the triangles of a leaf own, stored together: a search does not read TriangleTable.
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

/// Both tables are derived by Model::rebuild_outlines.
struct BvhTable {
    Column<Aabb> box;      // refitted when a pair of its body is searched again [m]
    Column<BvhNode> node;  // topology, built once from the rest shape

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
