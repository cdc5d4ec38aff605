#include "systems/dynamics/recovery/node_patches.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "systems/dynamics/recovery/surface_gradient.h"

namespace skerry {

namespace {

void sort_once(std::vector<Index>& list) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Inverts lists: row i of the result holds the numbers of the lists that contain i, ascending. `list(r)` returns list
/// number r of `count`.
template <class List>
Ragged<Index> inverted(std::size_t count, List&& list, std::size_t rows) {
    Ragged<Index> result;
    result.offset.resize(rows + 1);
    for (std::size_t r = 0; r < count; ++r)
        for (const Index i : list(r)) ++result.offset[static_cast<std::size_t>(i) + 1];
    for (std::size_t i = 0; i < rows; ++i) result.offset[i + 1] += result.offset[i];
    std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
    result.item.resize(static_cast<std::size_t>(result.offset[rows]));
    for (std::size_t r = 0; r < count; ++r)
        for (const Index i : list(r))
            result.item[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = static_cast<Index>(r);
    return result;
}

}  // namespace

NodePatches::NodePatches(std::span<const std::array<Index, 4>> tetrahedra,
                         std::span<const std::array<Index, 3>> surface, std::span<const Index> material,
                         std::span<const Vec3> rest)
    : tetrahedra_(tetrahedra),
      surface_(surface),
      material_(material),
      rest_(rest),
      tetrahedra_of_(inverted(
          tetrahedra.size(), [&](std::size_t t) { return std::span(tetrahedra[t]); }, rest.size())),
      triangles_of_(inverted(
          surface.size(), [&](std::size_t t) { return std::span(surface[t]); }, rest.size())),
      kind_(rest.size()) {}

NodeKind NodePatches::kind(Index node) {
    std::optional<NodeKind>& known = kind_[static_cast<std::size_t>(node)];
    if (!known) known = find_kind(node);
    return *known;
}

NodeKind NodePatches::find_kind(Index node) const {
    const std::span<const Index> around = tetrahedra(node);
    if (around.empty()) return NodeKind::other;
    for (const Index t : around)
        if (material_of(t) != material_of(around.front())) return NodeKind::other;
    if (triangles(node).empty()) return NodeKind::inner;
    return surface_around(surface_, triangles(node), rest_).smooth ? NodeKind::face : NodeKind::other;
}

std::vector<Index> NodePatches::materials_around(Index node) const {
    std::vector<Index> materials;
    for (const Index t : tetrahedra(node)) materials.push_back(material_of(t));
    sort_once(materials);
    return materials;
}

Real NodePatches::node_volume(Index node) const {
    Real sum = 0;
    for (const Index t : tetrahedra(node)) sum += volume(t) / 4;
    return sum;
}
Real NodePatches::node_volume(Index node, Index material) const {
    Real sum = 0;
    for (const Index t : tetrahedra(node))
        if (material_of(t) == material) sum += volume(t) / 4;
    return sum;
}

std::vector<Index> NodePatches::inner_neighbours(Index node) {
    std::vector<Index> inner;
    for (const Index t : tetrahedra(node))
        for (const Index n : tetrahedra_[static_cast<std::size_t>(t)])
            if (kind(n) == NodeKind::inner) inner.push_back(n);
    sort_once(inner);
    return inner;
}

std::vector<Index> NodePatches::donors(Index node, Index material) {
    std::vector<Index> nodes{node};
    for (int ring = 0; ring < 2; ++ring) {
        std::vector<Index> wider;
        for (const Index from : nodes)
            for (const Index t : tetrahedra(from))
                if (material_of(t) == material)
                    wider.insert(wider.end(), tetrahedra_[static_cast<std::size_t>(t)].begin(),
                                 tetrahedra_[static_cast<std::size_t>(t)].end());
        sort_once(wider);
        nodes = std::move(wider);
    }
    std::erase_if(nodes, [&](Index n) { return kind(n) == NodeKind::other; });
    return nodes;
}

ElementsNear::ElementsNear(const ElementCover& cover, std::span<const std::uint8_t> chosen) {
    const auto is_chosen = [&](Index t) { return chosen[static_cast<std::size_t>(t)] != 0; };
    for (std::size_t first = 0; first < cover.tetrahedra.size(); first += element_lanes) {
        const std::size_t last = std::min(first + element_lanes, cover.tetrahedra.size());
        const auto begin = static_cast<std::size_t>(cover.tetrahedra.offset[first]),
                   end = static_cast<std::size_t>(cover.tetrahedra.offset[last]);
        if (std::ranges::any_of(cover.tetrahedra.item.subspan(begin, end - begin), is_chosen))
            block.push_back(static_cast<Index>(first / element_lanes));
    }
    covering = inverted(
        block.size() * element_lanes, [&](std::size_t element) { return covered(cover, element); }, chosen.size());
}

std::span<const Index> ElementsNear::covered(const ElementCover& cover, std::size_t element) const {
    const std::size_t lane =
        static_cast<std::size_t>(block[element / element_lanes]) * element_lanes + element % element_lanes;
    return lane < cover.tetrahedra.size() ? cover.tetrahedra[lane] : std::span<const Index>{};
}

std::vector<Index> ElementsNear::around(std::span<const Index> tetrahedra) const {
    std::vector<Index> elements;
    for (const Index t : tetrahedra) {
        const std::span<const Index> covering_elements = covering[static_cast<std::size_t>(t)];
        elements.insert(elements.end(), covering_elements.begin(), covering_elements.end());
    }
    sort_once(elements);
    return elements;
}

}  // namespace skerry
