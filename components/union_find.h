// UnionFind: disjoint sets of indices that are joined one pair at a time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Disjoint sets of the indices 0 .. count-1: union-find with path halving (Tarjan, van Leeuwen 1984, Worst-case
/// analysis of set union algorithms). A join attaches the greater root to the smaller one, so the root of a set is its
/// smallest index, whatever the order of the joins. The next call of start() reuses the memory.
struct UnionFind {
    /// Parent, stamp and number of an index. root() and number() read all three at random indices, so they are stored
    /// side by side.
    struct Node {
        Index parent;
        // Value of `now`, the number of the present start(), when the node was written. `parent` and `number` are valid
        // only if the stamp equals the present `now`.
        std::uint32_t stamp;
        Index number;  // number of the set, stored at its root; no_index until it is assigned
    };

    Column<Node> node;
    std::uint32_t now = 0;
    Index number_count = 0;

    /// Makes each of the indices 0 .. count - 1 a set of its own. The function does not clear the memory, because nodes
    /// with an earlier stamp count as new.
    void start(std::size_t count) {
        if (node.size() < count) node.resize(count);
        if (now == std::numeric_limits<std::uint32_t>::max()) {
            for (Node& each : node) each.stamp = 0;
            now = 0;
        }
        ++now;
        number_count = 0;
    }

    /// Prefetches the node of `index` for a later call of root().
    void fetch(Index index) const { __builtin_prefetch(node.data() + index, 1); }

    Index root(Index index) {
        if (node[index].stamp != now) {
            node[index] = {index, now, no_index};
            return index;
        }
        while (node[index].parent != index) {
            const Index next = node[node[index].parent].parent;
            // Most paths are already short and need no write.
            if (next != node[index].parent) node[index].parent = next;
            index = next;
        }
        return index;
    }

    /// Joins the sets of two roots. Returns the root of the joined set.
    Index join_roots(Index a, Index b) {
        const Index winner = std::min(a, b);
        node[std::max(a, b)].parent = winner;
        return winner;
    }

    void join(Index a, Index b) { join_roots(root(a), root(b)); }

    /// The number of the set that contains `index`. Sets are numbered in the order in which number() is first called
    /// for them. Call it only after all joins.
    Index number(Index index) {
        Node& top = node[root(index)];
        if (top.number == no_index) top.number = number_count++;
        return top.number;
    }
};

}  // namespace skerry
