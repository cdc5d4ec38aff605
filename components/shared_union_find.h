// SharedUnionFind: disjoint sets of indices that any number of threads join at the same time.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <utility>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// The sets of UnionFind, without locks (Anderson, Woll 1991, Wait-free parallel algorithms for the union-find
/// problem): a root is hung below a smaller one by one exchange, which fails if another thread was first, and is then
/// tried again from the new root. So the root of a set is its smallest index here, too, however many threads joined it
/// in whatever order. Parent and stamp change together, and nothing else is read through them, so that no order of
/// memory is asked for; what has been joined by all threads they have to wait for by themselves.
struct SharedUnionFind {
    /// Both with the stamp of a start in their upper half: of an earlier one they hold nothing.
    struct Node {
        std::uint64_t parent;
        std::uint64_t first;  // item of the set, complemented: the smallest is the largest word. At its root
    };

    Column<Node> node;
    std::uint32_t now = 0;

    /// Makes each of `count` indices a set of its own. Nothing is cleared.
    void start(std::size_t count) {
        if (node.size() < count) node.resize(count);
        if (now == std::numeric_limits<std::uint32_t>::max()) {
            for (Node& each : node) each = {};
            now = 0;
        }
        ++now;
    }

    /// Brings `index` from the memory, for a root() that will be asked for soon.
    void fetch(Index index) const { __builtin_prefetch(node.data() + index, 1); }

    Index root(Index index) {
        while (true) {
            std::uint64_t word = load(node[index].parent);
            const Index parent = parent_in(word, index);
            if (parent == index) return index;
            const Index next = parent_in(load(node[parent].parent), parent);
            if (next == parent) return parent;
            // halves the path; whoever was first has halved it, too
            exchange(node[index].parent, word, stamped(next));
            index = next;
        }
    }

    /// Joins the sets of two indices. Returns the root of both as it was then.
    Index join(Index a, Index b) {
        while (true) {
            a = root(a);
            b = root(b);
            if (a == b) return a;
            if (a < b) std::swap(a, b);
            std::uint64_t word = load(node[a].parent);
            if (parent_in(word, a) == a && exchange(node[a].parent, word, stamped(b))) return b;
        }
    }

    /// Has the set of a root begin with an item unless it begins with a smaller one. Once nothing is joined any more.
    void begin_with(Index root, Index item) {
        const std::uint64_t mine = stamped(static_cast<Index>(~static_cast<std::uint32_t>(item)));
        std::uint64_t word = load(node[root].first);
        while (word < mine && !exchange(node[root].first, word, mine)) continue;
    }

    /// The smallest item that the set of a root was told, or no_index.
    Index first_item(Index root) {
        const std::uint64_t word = load(node[root].first);
        return stamp_of(word) == now ? static_cast<Index>(~static_cast<std::uint32_t>(word)) : no_index;
    }

private:
    static std::uint32_t stamp_of(std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32); }
    std::uint64_t stamped(Index low) const {
        return (static_cast<std::uint64_t>(now) << 32) | static_cast<std::uint32_t>(low);
    }
    Index parent_in(std::uint64_t word, Index index) const {
        return stamp_of(word) == now ? static_cast<Index>(static_cast<std::uint32_t>(word)) : index;
    }

    static std::uint64_t load(std::uint64_t& word) { return std::atomic_ref(word).load(std::memory_order_relaxed); }
    /// On failure `expected` is what stands there.
    static bool exchange(std::uint64_t& word, std::uint64_t& expected, std::uint64_t next) {
        return std::atomic_ref(word).compare_exchange_strong(expected, next, std::memory_order_relaxed);
    }
};

}  // namespace skerry
