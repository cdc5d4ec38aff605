// SharedUnionFind: disjoint sets of indices. Any number of threads may join sets at the same time.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <utility>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Lock-free variant of UnionFind (Anderson, Woll 1991, Wait-free parallel algorithms for the union-find problem). The
/// root of a set is its smallest index, whatever the number of threads and the order of the joins. Threads must
/// synchronise before they read the final sets.
struct SharedUnionFind {
    /// Each member is a word of two halves of 32 bits:
    /// - upper half, the stamp: value of `now`, the number of the present start(), when the word was written. A word
    ///   with an earlier stamp counts as empty.
    /// - lower half, the value: in `parent` the index of the parent, in `first` an item
    struct Node {
        std::uint64_t parent;
        // At the root: smallest item passed to begin_with(), stored as its bitwise complement. Complete words can then
        // be compared: a smaller item gives a larger word, and an empty word, with its earlier stamp, is the smallest.
        std::uint64_t first;
    };

    Column<Node> node;
    std::uint32_t now = 0;

    /// Makes each of the indices 0 .. count - 1 a set of its own. The function does not clear the memory, because words
    /// with an earlier stamp count as empty.
    void start(std::size_t count) {
        if (node.size() < count) node.resize(count);
        if (now == std::numeric_limits<std::uint32_t>::max()) {
            for (Node& each : node) each = {};
            now = 0;
        }
        ++now;
    }

    /// Prefetches the node of `index` for a later call of root().
    void fetch(Index index) const { __builtin_prefetch(node.data() + index, 1); }

    Index root(Index index) {
        while (true) {
            std::uint64_t word = load(node[index].parent);
            const Index parent = parent_in(word, index);
            if (parent == index) return index;
            const Index next = parent_in(load(node[parent].parent), parent);
            if (next == parent) return parent;
            // Path halving. If the exchange fails, another thread has already shortened the path.
            exchange(node[index].parent, word, stamped(next));
            index = next;
        }
    }

    /// Joins the sets of the indices a and b. Returns the root of the joined set at that time.
    Index join(Index a, Index b) {
        while (true) {
            a = root(a);
            b = root(b);
            if (a == b) return a;
            // The greater root is always attached to the smaller one, so parents are smaller than their children.
            if (a < b) std::swap(a, b);
            std::uint64_t word = load(node[a].parent);
            // If the exchange fails, another thread has attached `a` meanwhile; the join is repeated from the new root.
            if (parent_in(word, a) == a && exchange(node[a].parent, word, stamped(b))) return b;
        }
    }

    /// Records `item` for the set with the root `root`; first_item() returns the smallest recorded item. Call it only
    /// after all joins.
    void begin_with(Index root, Index item) {
        const std::uint64_t new_word = stamped(static_cast<Index>(~static_cast<std::uint32_t>(item)));
        std::uint64_t word = load(node[root].first);
        while (word < new_word && !exchange(node[root].first, word, new_word)) continue;
    }

    /// The smallest item passed to begin_with for the set with this root, or no_index.
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

    // Relaxed memory order suffices, because parent and stamp share one word, and no word tells a thread that other
    // data are ready.
    static std::uint64_t load(std::uint64_t& word) { return std::atomic_ref(word).load(std::memory_order_relaxed); }
    /// Compare-and-exchange of a word. On failure `expected` receives the current value of the word.
    static bool exchange(std::uint64_t& word, std::uint64_t& expected, std::uint64_t next) {
        return std::atomic_ref(word).compare_exchange_strong(expected, next, std::memory_order_relaxed);
    }
};

}  // namespace skerry
