// Bounding volume hierarchy over the triangles of one body (methods.md 6, item 2).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/surface_table.h"

namespace skerry {

/// Appends a tree over the triangles of one body, built from their present positions. A leaf holds one triangle: its box
/// is then at hand where triangles are compared (4 to a leaf: the search of a pair took more than twice as long).
Range append_bvh(Range triangles, std::span<const std::array<Index, 3>> triangle_node, std::span<const Vec3> position, BvhTable& bvh);

/// Fits the boxes of one tree around the present positions, bottom-up.
void refit_bvh(Range bvh_nodes, std::span<const BvhNode> node, std::span<const Index> leaf_triangle,
               std::span<const std::array<Index, 3>> triangle_node, std::span<const Vec3> position, std::span<Aabb> box);

}  // namespace skerry
