#include "engine/mesh/surface/sides.h"

#include <algorithm>
#include <utility>

#include "components/counting_sort.h"

namespace skerry::mesh {

std::vector<Side> sorted_sides(Triangles triangles) {
    std::vector<Side> sides, spare;
    Index end = 0;
    sides.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            Side side{{triangles[t][k], triangles[t][next]},
                      {static_cast<Index>(3 * t + k), static_cast<Index>(3 * t + next)}};
            if (side.node[0] > side.node[1]) {
                std::swap(side.node[0], side.node[1]);
                std::swap(side.corner[0], side.corner[1]);
            }
            sides.push_back(side);
            end = std::max(end, side.node[1] + 1);
        }
    counting_sort(sides, spare, end, [](const Side& side) { return side.node[1]; });
    counting_sort(sides, spare, end, [](const Side& side) { return side.node[0]; });
    return sides;
}

std::vector<Index> further_fans(Triangles triangles, UnionFind& fans) {
    std::vector<Index> first;                          // first fan of each node
    std::vector<std::pair<std::size_t, Index>> found;  // nodes and further fans
    for (std::size_t c = 0; c < 3 * triangles.size(); ++c) {
        const auto node = static_cast<std::size_t>(triangles[c / 3][c % 3]);
        const Index fan = fans.root(static_cast<Index>(c));
        if (node >= first.size()) first.resize(2 * node + 1, no_index);
        if (first[node] == no_index) first[node] = fan;
        if (first[node] != fan) found.emplace_back(node, fan);
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::vector<Index> corners;
    for (const auto& [node, fan] : found) corners.push_back(fan);
    return corners;
}

}  // namespace skerry::mesh
