// Which nodes implicit elements couple (docs/methods/clusters.md 2).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "components/union_find.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Whether an element holds a node.
inline bool holds(const ElementGradient& gradient, std::size_t l) {
    return gradient[0][l] != 0 || gradient[1][l] != 0 || gradient[2][l] != 0;
}

/// Calls visit(block, lane, modulus) for every implicit element; `modulus`: from blocks.begin on.
template <class Visit>
void for_each_implicit(Range blocks, std::span<const ElementLane> modulus, Visit&& visit) {
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (const Real m = modulus[b - static_cast<std::size_t>(blocks.begin)][l]; m > 0) visit(b, l, m);
}

/// Calls visit(node, k) for the moving nodes that an element holds.
template <class Visit>
void for_each_node(const BlockNodes& nodes, std::size_t l, std::span<const Real> inverse_mass, Visit&& visit) {
    for (Index k = 0; k < nodes.count; ++k) {
        const Index n = nodes.node[k][l];
        if (holds(nodes.gradient[k], l) && inverse_mass[static_cast<std::size_t>(n)] > 0) visit(n, k);
    }
}

/// The moving nodes of a body that its implicit elements chain, guards left out: they act within a cluster alone.
struct NodeChains {
    Index first = 0;                    // node, of those that are chained
    UnionFind sets;                     // by node from there on
    std::vector<std::uint8_t> chained;  // by node from there on, as far as the last

    /// `modulus`: from blocks.begin on.
    NodeChains(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus,
               std::span<const Real> inverse_mass) {
        std::vector<Index> nodes;
        const auto for_each = [&](auto&& visit) {
            for_each_implicit(blocks, modulus, [&](std::size_t b, std::size_t l, Real) {
                if (elements.part[b] == ElementPart::guard) return;
                Index before = no_index;
                for_each_node(elements.nodes_of(b), l, inverse_mass, [&](Index n, Index) {
                    visit(before, n);
                    before = n;
                });
            });
        };
        for_each([&](Index, Index n) { nodes.push_back(n); });
        if (nodes.empty()) return;
        // the nodes of a body lie side by side
        const auto ends = std::ranges::minmax(nodes);
        first = ends.min;
        sets.start(static_cast<std::size_t>(ends.max - first) + 1);
        chained.resize(static_cast<std::size_t>(ends.max - first) + 1);
        for_each([&](Index before, Index n) {
            chained[static_cast<std::size_t>(n - first)] = 1;
            if (before != no_index) sets.join(before - first, n - first);
        });
    }

    /// Of the set of a node; no_index where nothing chains it.
    Index root_of(Index node) {
        const Index row = node - first;
        if (row < 0 || row >= static_cast<Index>(chained.size()) || chained[static_cast<std::size_t>(row)] == 0)
            return no_index;
        return sets.root(row);
    }
};

}  // namespace skerry
