#include "systems/dynamics/elements/touched_elements.h"

#include <algorithm>

namespace skerry {

namespace {

/// visit(row of NodeTable) for all nodes of the elements of a block, some of them several times.
void for_each_node(const ElementBlockTable& elements, const ElementNodeTable& nodes, std::size_t block, auto&& visit) {
    const auto first = static_cast<std::size_t>(elements.first[block]);
    for (std::size_t row = first; row < first + static_cast<std::size_t>(elements.count[block]); ++row)
        for (std::size_t l = 0; l < element_lanes; ++l) visit(static_cast<std::size_t>(nodes.node[row][l]));
}

}  // namespace

void find_touched_blocks(const ElementNodeTable& nodes, std::span<const std::uint8_t> node_touched, Range blocks,
                         ElementBlockTable& elements) {
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        std::uint8_t any = 0;
        for_each_node(elements, nodes, b, [&](std::size_t n) { any |= node_touched[n]; });
        elements.touched[b] = any;
    }
}

bool mark_touched(const ElementBlockTable& elements, const ElementNodeTable& element_nodes, Range blocks, Range nodes,
                  ElementPatches& patches, std::span<LevelMask> node_levels) {
    constexpr auto touched_bit = static_cast<LevelMask>(1u << touched_level);
    for (auto n = static_cast<std::size_t>(nodes.begin); n < static_cast<std::size_t>(nodes.end); ++n)
        node_levels[n] &= static_cast<LevelMask>(~touched_bit);
    bool any = false;
    const auto first = std::ranges::lower_bound(patches.blocks, blocks.begin, {}, &Range::begin);
    for (auto p = static_cast<std::size_t>(first - patches.blocks.begin());
         p < patches.blocks.size() && patches.blocks[p].begin < blocks.end; ++p) {
        const Range of_patch = patches.blocks[p], slots = patches.slots[p];
        std::uint8_t touched = 0;
        for (auto b = static_cast<std::size_t>(of_patch.begin); b < static_cast<std::size_t>(of_patch.end); ++b) {
            if (!elements.touched[b]) continue;
            touched = 1;
            for_each_node(elements, element_nodes, b, [&](std::size_t n) { node_levels[n] |= touched_bit; });
        }
        patches.touched[p] = touched;
        const std::uint8_t level = touched ? touched_level : elements.level[static_cast<std::size_t>(of_patch.begin)];
        std::fill(patches.level.begin() + slots.begin, patches.level.begin() + slots.end, level);
        any |= touched != 0;
    }
    return any;
}

}  // namespace skerry
