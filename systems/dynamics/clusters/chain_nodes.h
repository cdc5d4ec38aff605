// Finds the nodes that implicit elements couple (docs/methods/clusters.md 2).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "components/union_find.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// True if the element in lane `l` has a nonzero shape gradient at a node, so that it exerts forces on the node.
inline bool acts_on_node(const ElementGradient& gradient, std::size_t l) {
    return gradient[0][l] != 0 || gradient[1][l] != 0 || gradient[2][l] != 0;
}

/// Calls visit(block, lane, modulus) for every implicit element. `modulus`: assumed moduli by block, 0 for explicit
/// elements; row 0 belongs to the block blocks.begin.
template <class Visit>
void for_each_implicit(Range blocks, std::span<const ElementLane> modulus, Visit&& visit) {
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (const Real m = modulus[b - static_cast<std::size_t>(blocks.begin)][l]; m > 0) visit(b, l, m);
}

/// Calls visit(node, k) for every moving node on which the element in lane `l` acts; k is the index of the node in the
/// element.
template <class Visit>
void for_each_node(const BlockNodes& nodes, std::size_t l, std::span<const Real> inverse_mass, Visit&& visit) {
    for (Index k = 0; k < nodes.count; ++k) {
        const Index n = nodes.node[k][l];
        if (acts_on_node(nodes.gradient[k], l) && inverse_mass[static_cast<std::size_t>(n)] > 0) visit(n, k);
    }
}

/// Sets of moving nodes that the implicit elements of a body connect. Guards (inversion barriers) are left out, since
/// they act only inside clusters that other elements form.
struct ConnectedNodes {
    Index first = 0;                         // smallest row of NodeTable among the connected nodes
    UnionFind sets;                          // numbered by row of NodeTable minus `first`
    std::vector<std::uint8_t> is_connected;  // 1 for connected nodes; by row of NodeTable minus `first`

    /// `modulus`: assumed moduli by block; row 0 belongs to the block blocks.begin.
    ConnectedNodes(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus,
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
        // The nodes of a body are consecutive rows of NodeTable, so arrays from the first to the last connected node
        // suffice.
        const auto ends = std::ranges::minmax(nodes);
        first = ends.min;
        sets.start(static_cast<std::size_t>(ends.max - first) + 1);
        is_connected.resize(static_cast<std::size_t>(ends.max - first) + 1);
        for_each([&](Index before, Index n) {
            is_connected[static_cast<std::size_t>(n - first)] = 1;
            if (before != no_index) sets.join(before - first, n - first);
        });
    }

    /// Root of the set that contains `node` (row of NodeTable); no_index if no implicit element except guards acts on
    /// `node`. The root is a row of NodeTable minus `first`.
    Index root_of(Index node) {
        const Index row = node - first;
        if (row < 0 || row >= static_cast<Index>(is_connected.size()) ||
            is_connected[static_cast<std::size_t>(row)] == 0)
            return no_index;
        return sets.root(row);
    }
};

}  // namespace skerry
