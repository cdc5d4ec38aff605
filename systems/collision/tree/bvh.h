// Bounding volume hierarchy over the triangles of one body (docs/methods/collision.md 3).
#pragma once

#include <span>

#include "components/append_copies.h"
#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/surface_table.h"

namespace skerry {

struct BvhRanges {
    Range nodes;   // rows of BvhTable
    Range leaves;  // rows of BvhLeafTable
};

/// Appends a tree over the triangles of one body, built from `position`. A leaf contains at most eight triangles,
/// because a search compares a feature with eight triangles at once.
BvhRanges append_bvh(Range triangles, std::span<const std::array<Index, 3>> triangle_node,
                     std::span<const Vec3> position, BvhTable& bvh, BvhLeafTable& leaves);

/// Lists the features that the triangles in each of the given leaves own. These leaves must be the last rows of
/// BvhLeafTable.
void append_leaf_features(Range bvh_leaves, const TriangleTable& triangles, BvhLeafTable& leaves);

/// Appends the tree and the leaf features of a body by copying those of an earlier body with the same mesh. `original`:
/// rows of the earlier body. `offset`: offsets from rows of the earlier body to rows of the new body. The appended rows
/// equal those of append_bvh and append_leaf_features.
BvhRanges append_bvh_copy(const BvhRanges& original, const RowOffsets& offset, std::span<const Vec3> position,
                          BvhTable& bvh, BvhLeafTable& leaves);

/// Computes the boxes of one tree from `position`, from the leaves upwards. `position` may also hold other vectors by
/// node, for example velocities (self_motion.cpp).
void refit_bvh(Range bvh_nodes, std::span<const BvhNode> node, std::span<const LeafNodes> leaf_nodes,
               std::span<const Vec3> position, std::span<Aabb> box);

}  // namespace skerry
