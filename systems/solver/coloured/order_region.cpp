#include "systems/solver/coloured/order_region.h"

namespace skerry {
namespace {

/// Writes the moving nodes of all contacts to region.moving. Returns true if they equal the nodes that the last call
/// wrote.
bool read_nodes(const RegionInputs& inputs, std::span<const Index> row, Team& team, ColouredRegion& region) {
    const bool same_count = region.moving.size() == row.size();
    region.moving.resize(row.size());
    const std::size_t blocks = static_cast<std::size_t>(row_block_count(row.size()));
    if (region.same_nodes.size() < blocks) region.same_nodes.resize(blocks);
    for_row_blocks(team, row.size(), [&](std::size_t begin, std::size_t end, Index block) {
        bool same = true;
        for (std::size_t k = begin; k < end; ++k) {
            const ContactNodes nodes = moving_nodes(inputs, row[k]);
            same = same && nodes == region.moving[k];
            region.moving[k] = nodes;
        }
        region.same_nodes[block] = same;
    });
    bool same = same_count;
    for (std::size_t block = 0; block < blocks; ++block) same = same && region.same_nodes[block] != 0;
    return same;
}

/// Numbers the nodes of the region in the order of their first appearance. `node_number` stores the number of each
/// node, by row of NodeTable. It is not cleared between calls, so an entry is valid only if region.node holds this node
/// at the stored number.
void number_nodes(std::span<Index> node_number, ColouredRegion& region) {
    region.node.clear();
    region.local.resize(region.moving.size());
    for (std::size_t k = 0; k < region.moving.size(); ++k) {
        ContactNodes& local = region.local[k];
        for (std::size_t a = 0; a < local.size(); ++a) {
            const Index global = region.moving[k][a];
            if (global == no_index) {
                local[a] = no_index;
                continue;
            }
            Index& number = node_number[global];
            if (static_cast<std::size_t>(number) >= region.node.size() || region.node[number] != global) {
                number = static_cast<Index>(region.node.size());
                region.node.push_back(global);
            }
            local[a] = number;
        }
    }
}

}  // namespace

ContactNodes moving_nodes(const RegionInputs& inputs, Index row) {
    const Stencil& stencil = inputs.stencil[row];
    ContactNodes nodes{no_index, no_index, no_index, no_index};
    std::size_t count = 0;
    for (std::size_t a = 0; a < nodes.size(); ++a)
        if (stencil.weight[a] != 0 && inputs.inverse_mass[stencil.node[a]] > 0) nodes[count++] = stencil.node[a];
    return nodes;
}

bool order_region(const RegionInputs& inputs, std::span<const Index> row, Team& team, std::span<Index> node_number,
                  ColouredRegion& region) {
    if (read_nodes(inputs, row, team, region)) return false;
    number_nodes(node_number, region);
    colour_contacts(region.local, static_cast<Index>(region.node.size()), region.colouring, region.order);
    if (region.partial.size() < block_count(region.order)) region.partial.resize(block_count(region.order));
    return true;
}

}  // namespace skerry
