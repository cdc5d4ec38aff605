// Simultaneous traversal of two bounding volume hierarchies.
#pragma once

#include <span>

#include "components/bvh_table.h"

namespace skerry {

/// Visits pairs of leaves below the nodes a and b of two trees, until a visit returns true. Returns true if a visit
/// did. `self`: both nodes belong to one tree that is paired with itself; then each leaf is also visited with itself. A
/// pair of leaves is visited if near(a, b) is true for the leaves and for all pairs of nodes above them.
template <class Near, class Visit>
bool any_leaf_pair(std::span<const BvhNode> node, Index a, Index b, bool self, const Near& near, const Visit& visit) {
    const bool same = self && a == b;
    if (!same && !near(a, b)) return false;
    const BvhNode &own = node[a], &other = node[b];
    if (own.count > 0 && other.count > 0) return visit(a, b);
    const auto below = [&](Index c, Index d) { return any_leaf_pair(node, c, d, self, near, visit); };
    if (same) return below(a + 1, a + 1) || below(own.right, own.right) || below(a + 1, own.right);
    // the node with more descendants is split
    if (other.count > 0 || (own.count == 0 && own.skip - a >= other.skip - b))
        return below(a + 1, b) || below(own.right, b);
    return below(a, b + 1) || below(a, other.right);
}

}  // namespace skerry
