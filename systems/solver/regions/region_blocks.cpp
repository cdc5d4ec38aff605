#include "systems/solver/regions/region_blocks.h"

#include <algorithm>

namespace skerry {
namespace {

/// Lists a cluster or rigid body (`block`) at most once per region. `region_of` stores the last region that listed the
/// block.
void add_region(Index block, Index region, Column<Index>& region_of, Ragged<Index>& list) {
    if (block == no_index || region_of[static_cast<std::size_t>(block)] == region) return;
    region_of[static_cast<std::size_t>(block)] = region;
    list.item.push_back(block);
}

/// Lists the clusters and rigid bodies of the nodes of a stencil.
void list_groups_of(const RegionInputs& inputs, const Stencil& stencil, Index number, RegionMemory& memory) {
    for (std::size_t a = 0; a < 4; ++a) {
        if (stencil.weight[a] == 0) continue;
        if (inputs.clustered())
            add_region(inputs.clusters->cluster(stencil.node[a]), number, memory.region_of_cluster,
                       memory.region_clusters);
        // Held nodes (inverse mass 0) are left out, because no impulse moves them.
        if (inputs.inverse_mass[static_cast<std::size_t>(stencil.node[a])] > 0)
            add_region(inputs.rigid.nodes.row(stencil.node[a]), number, memory.region_of_rigid, memory.region_rigid);
    }
}

}  // namespace

std::size_t points_of_cables(const RegionInputs& inputs, std::span<const Index> cables) {
    std::size_t count = 0;
    for (const Index cable : cables)
        count += static_cast<std::size_t>(inputs.cables.block[static_cast<std::size_t>(cable)].points.size());
    return count;
}

std::size_t room_of_region(const RegionInputs& inputs, const RegionMemory& memory, std::size_t stencils, Index number) {
    const auto r = static_cast<std::size_t>(number);
    std::size_t room = 4 * stencils;
    for (const Index body : memory.region_rigid[r]) {
        room += 2;
        // An impulse moves all nodes of the implicit body that have contacts, so the region needs rows for all of them.
        if (inputs.implicit.any()) room += inputs.implicit.coupling->nodes[static_cast<std::size_t>(body)].size();
    }
    for (const Index c : memory.region_clusters[r]) room += inputs.clusters->nodes[static_cast<std::size_t>(c)].size();
    return room;
}

std::size_t find_region_blocks(const RegionInputs& inputs, const RegionTable& regions, RegionMemory& memory) {
    // The columns by node begin with four entries for each contact of the step. These entries belong to regions without
    // clusters and rigid bodies. The entries of the other regions follow.
    std::size_t end = 4 * regions.contacts.item.size();
    memory.rows = memory.contact_rows = regions.contacts.item.size();
    memory.region_clusters.clear();
    memory.region_rigid.clear();
    memory.region_has_axes.clear();
    const bool any_cable = !inputs.cables.block.empty();
    if (!inputs.clustered() && !inputs.rigid.any() && !any_cable && inputs.friction_axis.empty()) return end;
    memory.region_clusters.offset.push_back(0);
    memory.region_rigid.offset.push_back(0);
    if (!inputs.joints.empty() || any_cable) memory.joint_base.resize(regions.size());
    memory.node_base.resize(regions.size());
    memory.region_of_cluster.assign(inputs.clustered() ? inputs.clusters->size() : 0, no_index);
    memory.region_of_rigid.assign(inputs.rigid.mass.size(), no_index);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const auto number = static_cast<Index>(r);
        memory.node_base[r] = end;
        for (const Index contact : regions.contacts[r])
            list_groups_of(inputs, inputs.stencil[static_cast<std::size_t>(contact)], number, memory);
        for (const Index cable : regions.cables_of(r))
            for (const Stencil& of_point :
                 rows_of(inputs.cables.stencil, inputs.cables.block[static_cast<std::size_t>(cable)].points))
                list_groups_of(inputs, of_point, number, memory);
        for (const Index joint : regions.joints_of(r)) {
            const JointBlock& block = inputs.joints[static_cast<std::size_t>(joint)];
            if (block.first_node != no_index)
                add_region(block.first, number, memory.region_of_rigid, memory.region_rigid);
            if (block.second_node != no_index)
                add_region(block.second, number, memory.region_of_rigid, memory.region_rigid);
        }
        const std::size_t contacts = regions.contacts[r].size(), joints = regions.joints_of(r).size(),
                          points = points_of_cables(inputs, regions.cables_of(r));
        if (joints + points > 0) {
            memory.joint_base[r] = memory.rows;
            memory.rows += contacts + joints + points;
        }
        memory.region_clusters.offset.push_back(static_cast<Index>(memory.region_clusters.item.size()));
        memory.region_rigid.offset.push_back(static_cast<Index>(memory.region_rigid.item.size()));
        if (!inputs.friction_axis.empty())
            memory.region_has_axes.push_back(std::ranges::any_of(regions.contacts[r], [&](Index contact) {
                return inputs.friction_axis[static_cast<std::size_t>(contact)].across != 1;
            }));
        if (touches_cluster(memory, number) || needs_blocks(memory, regions, number))
            end += room_of_region(inputs, memory, contacts + points, number);
    }
    return end;
}

}  // namespace skerry
