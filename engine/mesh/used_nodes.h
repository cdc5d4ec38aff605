// Removal of nodes that no element uses.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "components/types.h"

namespace skerry::mesh {

/// Positions of the nodes that are used, and their indices in the list of all nodes.
struct UsedNodes {
    std::vector<Vec3> nodes;
    std::vector<Index> number;
};

/// Removes nodes that no element uses. `rows`: node indices of each element, which are changed to the new indices. The
/// remaining nodes stay in order.
template <std::size_t N>
UsedNodes drop_unused(const std::vector<Vec3>& nodes, std::vector<std::array<Index, N>>& rows) {
    std::vector<Index> new_index(nodes.size(), no_index);
    for (const std::array<Index, N>& row : rows)
        for (const Index n : row) new_index[static_cast<std::size_t>(n)] = 0;
    UsedNodes used;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (new_index[n] == no_index) continue;
        new_index[n] = static_cast<Index>(used.nodes.size());
        used.nodes.push_back(nodes[n]);
        used.number.push_back(static_cast<Index>(n));
    }
    for (std::array<Index, N>& row : rows)
        for (Index& n : row) n = new_index[static_cast<std::size_t>(n)];
    return used;
}

}  // namespace skerry::mesh
