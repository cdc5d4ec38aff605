// Simultaneous traversal of two bounding volume hierarchies.
#pragma once

#include <span>

#include "components/bvh_table.h"

namespace skerry {

/// Descends two trees from node a of one and node b of the other, and calls visit(c, d) for each pair of leaves that it
/// reaches, until a call returns true. Returns true if a call returned true.
/// - near(c, d): true if two tree nodes are close to each other; the descent ends at pairs of nodes that are not.
/// - `self`: a and b belong to the same tree, which is paired with itself; each node is then also paired with itself.
template <class Near, class Visit>
bool any_leaf_pair(std::span<const BvhNode> node, Index a, Index b, bool self, const Near& near, const Visit& visit) {
    if (!near(a, b)) return false;
    const BvhNode &own = node[a], &other = node[b];
    if (own.count > 0 && other.count > 0) return visit(a, b);
    const auto below = [&](Index c, Index d) { return any_leaf_pair(node, c, d, self, near, visit); };
    if (self && a == b) return below(a + 1, a + 1) || below(own.right, own.right) || below(a + 1, own.right);
    // The node with more descendants is split.
    if (other.count > 0 || (own.count == 0 && own.skip - a >= other.skip - b))
        return below(a + 1, b) || below(own.right, b);
    return below(a, b + 1) || below(a, other.right);
}

}  // namespace skerry
