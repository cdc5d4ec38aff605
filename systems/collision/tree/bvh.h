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

/// Appends a tree over the triangles of one body, built from their present positions. A leaf holds up to eight
/// triangles, which a search compares with a feature all at once.
BvhRanges append_bvh(Range triangles, std::span<const std::array<Index, 3>> triangle_node,
                     std::span<const Vec3> position, BvhTable& bvh, BvhLeafTable& leaves);

/// Lists the features that the triangles of these leaves own. The leaves must be the last rows.
void append_leaf_features(Range bvh_leaves, const TriangleTable& triangles, BvhLeafTable& leaves);

/// Appends the tree and the leaf features of a body with the same mesh as an earlier one, whose rows are `like`.
/// `behind`: row offsets from the earlier body. The result equals that of append_bvh and append_leaf_features.
BvhRanges append_bvh_again(const BvhRanges& like, const RowsBehind& behind, std::span<const Vec3> position,
                           BvhTable& bvh, BvhLeafTable& leaves);

/// Fits the boxes of one tree around the present positions, bottom-up.
void refit_bvh(Range bvh_nodes, std::span<const BvhNode> node, std::span<const LeafNodes> leaf_nodes,
               std::span<const Vec3> position, std::span<Aabb> box);

}  // namespace skerry
