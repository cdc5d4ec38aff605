// Traversal of two bounding volume hierarchies at once.
#pragma once

#include <span>

#include "components/bvh_table.h"

namespace skerry {

/// Visits pairs of leaves below the nodes a and b of two trees, or of one tree paired with itself (`self`), until a
/// visit returns true; returns whether one did. `near(a, b)` must hold for the leaves and for all nodes above them. A
/// leaf of a tree paired with itself is visited with itself, too.
template <class Near, class Visit>
bool any_leaf_pair(std::span<const BvhNode> node, Index a, Index b, bool self, const Near& near, const Visit& visit) {
    const bool same = self && a == b;
    if (!same && !near(a, b)) return false;
    const BvhNode &own = node[a], &other = node[b];
    if (own.count > 0 && other.count > 0) return visit(a, b);
    const auto below = [&](Index c, Index d) { return any_leaf_pair(node, c, d, self, near, visit); };
    if (same) return below(a + 1, a + 1) || below(own.right, own.right) || below(a + 1, own.right);
    // the one that has more below it is split
    if (other.count > 0 || (own.count == 0 && own.skip - a >= other.skip - b))
        return below(a + 1, b) || below(own.right, b);
    return below(a, b + 1) || below(a, other.right);
}

}  // namespace skerry
