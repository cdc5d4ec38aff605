// Finds the nodes that implicit elements couple (docs/methods/clusters.md 2).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "components/union_find.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// True if the element in lane `l` acts on a node, that is, has a gradient there.
inline bool holds(const ElementGradient& gradient, std::size_t l) {
    return gradient[0][l] != 0 || gradient[1][l] != 0 || gradient[2][l] != 0;
}

/// Calls visit(block, lane, modulus) for every implicit element. `modulus` begins at the row of blocks.begin.
template <class Visit>
void for_each_implicit(Range blocks, std::span<const ElementLane> modulus, Visit&& visit) {
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (const Real m = modulus[b - static_cast<std::size_t>(blocks.begin)][l]; m > 0) visit(b, l, m);
}

/// Calls visit(node, k) for the moving nodes on which the element in lane `l` acts.
template <class Visit>
void for_each_node(const BlockNodes& nodes, std::size_t l, std::span<const Real> inverse_mass, Visit&& visit) {
    for (Index k = 0; k < nodes.count; ++k) {
        const Index n = nodes.node[k][l];
        if (holds(nodes.gradient[k], l) && inverse_mass[static_cast<std::size_t>(n)] > 0) visit(n, k);
    }
}

/// Sets of moving nodes of a body that its implicit elements connect. Guards are left out: they only act within a
/// cluster.
struct NodeChains {
    Index first = 0;                    // first node with an implicit element
    UnionFind sets;                     // by node - first
    std::vector<std::uint8_t> chained;  // by node - first, up to the last connected node

    /// `modulus` begins at the row of blocks.begin.
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
        // the nodes of a body are consecutive rows
        const auto ends = std::ranges::minmax(nodes);
        first = ends.min;
        sets.start(static_cast<std::size_t>(ends.max - first) + 1);
        chained.resize(static_cast<std::size_t>(ends.max - first) + 1);
        for_each([&](Index before, Index n) {
            chained[static_cast<std::size_t>(n - first)] = 1;
            if (before != no_index) sets.join(before - first, n - first);
        });
    }

    /// Root of the set of a node; no_index if no implicit element acts on the node.
    Index root_of(Index node) {
        const Index row = node - first;
        if (row < 0 || row >= static_cast<Index>(chained.size()) || chained[static_cast<std::size_t>(row)] == 0)
            return no_index;
        return sets.root(row);
    }
};

}  // namespace skerry
