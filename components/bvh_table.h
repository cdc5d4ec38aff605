// Bounding volume hierarchies of all bodies, body after body.
#pragma once

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Axis-aligned box.
struct Aabb {
    Vec3 lower;  // m
    Vec3 upper;  // m
};

/// A node of a tree stored in depth-first order: the left child of row i is i + 1, and `skip` is one past its last descendant.
/// A leaf (count > 0) holds the triangles first .. first + count - 1 of Bvhs::triangle.
struct BvhNode {
    Index skip;
    Index right;  // row of the right child; no_index in a leaf
    Index first;  // row of BvhTable::triangle
    Index count;  // 0 in an inner node
};

struct BvhTable {
    Column<Aabb> box;        // m, refit when a pair of its body is looked at again
    Column<BvhNode> node;    // topology, built once from the rest shape
    Column<Index> triangle;  // rows of TriangleTable in leaf order

    void for_each_column(auto&& visit) {
        visit("box", box);
        visit("node", node);
        visit("triangle", triangle);
    }
};

}  // namespace skerry
