// Bounding volume hierarchy over the triangles of one body (docs/methods/collision.md 3).
#pragma once

#include <span>

#include "components/append_again.h"
#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/surface_table.h"

namespace skerry {

struct BvhRanges {
    Range nodes;   // of BvhTable
    Range leaves;  // of BvhLeafTable
};

/// Appends a tree over the triangles of one body, built from their present positions. A leaf contains up to eight
/// triangles, because a search compares a feature with eight triangles at once.
BvhRanges append_bvh(Range triangles, std::span<const std::array<Index, 3>> triangle_node,
                     std::span<const Vec3> position, BvhTable& bvh, BvhLeafTable& leaves);

/// Lists the features that are owned by the triangles of the given leaves. These leaves must be the last rows.
void append_leaf_features(Range bvh_leaves, const TriangleTable& triangles, BvhLeafTable& leaves);

/// Appends the tree and the leaf features of a body by copying those of an earlier body with the same mesh. `like`:
/// rows of the earlier body. `behind`: new row minus earlier row. The result equals that of append_bvh and
/// append_leaf_features.
BvhRanges append_bvh_again(const BvhRanges& like, const RowsBehind& behind, std::span<const Vec3> position,
                           BvhTable& bvh, BvhLeafTable& leaves);

/// Fits the boxes of one tree to the present positions, from the leaves upwards.
void refit_bvh(Range bvh_nodes, std::span<const BvhNode> node, std::span<const LeafNodes> leaf_nodes,
               std::span<const Vec3> position, std::span<Aabb> box);

}  // namespace skerry
