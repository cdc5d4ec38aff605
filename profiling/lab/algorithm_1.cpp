#include "profiling/lab/algorithm_1.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace skerry::lab {
namespace {

template <class Visit>
void for_each_moving_node(const Stencil& stencil, std::span<const Real> inverse_mass, Visit&& visit) {
    for (std::size_t a = 0; a < 4; ++a)
        if (stencil.weight[a] != 0 && inverse_mass[stencil.node[a]] > 0)
            visit(static_cast<std::size_t>(stencil.node[a]));
}

bool has_moving_node(const Stencil& stencil, std::span<const Real> inverse_mass) {
    bool moves = false;
    for_each_moving_node(stencil, inverse_mass, [&](std::size_t) { moves = true; });
    return moves;
}

}  // namespace

Index label_by_algorithm_1(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                           std::span<Index> contact_region) {
    std::fill(contact_region.begin(), contact_region.end(), no_index);
    std::vector<std::size_t> in_area(inverse_mass.size(), 0);  // by node: 1 + the i that last marked it
    Index area_count = 0;
    for (std::size_t i = 0; i < stencil.size(); ++i) {
        if (!has_moving_node(stencil[i], inverse_mass)) continue;
        if (contact_region[i] == no_index) contact_region[i] = area_count++;
        const Index area = contact_region[i];
        const auto mark = [&](std::size_t node) { in_area[node] = i + 1; };
        for (std::size_t k = 0; k < stencil.size(); ++k)
            if (contact_region[k] == area) for_each_moving_node(stencil[k], inverse_mass, mark);
        for (std::size_t j = i + 1; j < stencil.size(); ++j) {
            // This is the omission of the paper: an area that has a number is not merged.
            if (contact_region[j] != no_index) continue;
            bool shares = false;
            for_each_moving_node(stencil[j], inverse_mass, [&](std::size_t node) { shares |= in_area[node] == i + 1; });
            if (!shares) continue;
            contact_region[j] = area;
            for_each_moving_node(stencil[j], inverse_mass, mark);
        }
    }
    return area_count;
}

Index count_shared_nodes(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                         std::span<const Index> contact_region) {
    std::vector<std::pair<std::size_t, Index>> node_region;
    for (std::size_t i = 0; i < stencil.size(); ++i)
        if (contact_region[i] != no_index)
            for_each_moving_node(stencil[i], inverse_mass,
                                 [&](std::size_t node) { node_region.emplace_back(node, contact_region[i]); });
    std::sort(node_region.begin(), node_region.end());
    node_region.erase(std::unique(node_region.begin(), node_region.end()), node_region.end());
    std::set<std::pair<Index, Index>> pairs;
    for (std::size_t i = 0; i < node_region.size(); ++i)
        for (std::size_t j = i + 1; j < node_region.size() && node_region[j].first == node_region[i].first; ++j)
            pairs.emplace(node_region[i].second, node_region[j].second);
    return static_cast<Index>(pairs.size());
}

}  // namespace skerry::lab
