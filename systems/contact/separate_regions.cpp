#include "systems/contact/separate_regions.h"

#include <algorithm>

#include "components/check.h"

namespace skerry {
namespace {

/// True if an impulse at this contact can move any node.
bool has_moving_node(const Stencil& stencil, std::span<const Real> inverse_mass) {
    for (std::size_t a = 0; a < 4; ++a)
        if (stencil.weight[a] != 0 && inverse_mass[stencil.node[a]] > 0) return true;
    return false;
}

/// Joins the sets of all moving nodes of a contact. `leader(node)`: the node that represents the group (rigid body or
/// cluster) of `node`. Returns the root of the joined set, or no_index if no node can move.
template <class Leader>
Index unite(const Stencil& stencil, std::span<const Real> inverse_mass, const Leader& leader, UnionFind& sets) {
    Index root = no_index;
    for (std::size_t a = 0; a < 4; ++a) {
        const Index at = stencil.node[a];
        if (stencil.weight[a] == 0 || !(inverse_mass[at] > 0)) continue;
        const Index other = sets.root(leader(at));
        if (root == other) continue;
        root = root == no_index ? other : sets.join_roots(root, other);
    }
    return root;
}

/// Writes the region of each contact and returns the number of regions. Regions are numbered in the order of their
/// first contacts.
template <class Leader>
Index label_by_union_find(std::span<const Stencil> stencil, std::span<const Real> inverse_mass, const Leader& leader,
                          const NodeGroups& groups, UnionFind& sets, std::span<Index> contact_region) {
    sets.start(inverse_mass.size());
    for (const JointBlock& joint : groups.joints)
        joint.join_nodes([&](Index first, Index second) { sets.join(first, second); });
    groups.join_cables(inverse_mass, sets);
    constexpr std::size_t ahead = 12;  // prefetch the data of the contact that comes this many contacts later
    const auto fetch = [&](const Stencil& next) {
        for (const Index node : next.node) {
            sets.fetch(node);
            __builtin_prefetch(&inverse_mass[node]);
        }
    };
    for (std::size_t i = 0; i < stencil.size(); ++i) {
        if (i + ahead < stencil.size()) fetch(stencil[i + ahead]);
        contact_region[i] = unite(stencil[i], inverse_mass, leader, sets);
    }
    groups.leave_out_other_ranks(stencil, contact_region);
    for (std::size_t i = 0; i < contact_region.size(); ++i) {
        if (i + ahead < contact_region.size() && contact_region[i + ahead] != no_index)
            sets.fetch(contact_region[i + ahead]);
        if (contact_region[i] != no_index) contact_region[i] = sets.number(contact_region[i]);
    }
    return sets.number_count;
}

Index label_single_region(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                          std::span<Index> contact_region) {
    bool any = false;
    for (std::size_t i = 0; i < stencil.size(); ++i) {
        const bool moves = has_moving_node(stencil[i], inverse_mass);
        contact_region[i] = moves ? 0 : no_index;
        any |= moves;
    }
    return any ? 1 : 0;
}

/// Counting sort of `count` contacts, joints or cables by region. The sort is stable, so the contacts, joints or cables
/// of a region stay in ascending order.
template <class RegionOf>
void collect(std::size_t count, const RegionOf& region_of, Index region_count, Ragged<Index>& list) {
    Column<Index>& offset = list.offset;
    offset.assign(static_cast<std::size_t>(region_count) + 1, 0);
    for (std::size_t i = 0; i < count; ++i)
        if (region_of(i) != no_index) ++offset[region_of(i) + 1];
    for (Index r = 0; r < region_count; ++r) offset[r + 1] += offset[r];
    list.item.resize(static_cast<std::size_t>(offset[region_count]));
    for (std::size_t i = 0; i < count; ++i)
        if (region_of(i) != no_index) list.item[offset[region_of(i)]++] = static_cast<Index>(i);
    // filling has moved each offset to the start of the next region, so move the offsets back
    for (Index r = region_count; r > 0; --r) offset[r] = offset[r - 1];
    offset[0] = 0;
}

void collect_contacts(std::span<const Index> contact_region, Index region_count, RegionTable& regions) {
    collect(
        contact_region.size(), [&](std::size_t i) { return contact_region[i]; }, region_count, regions.contacts);
}

/// Sorts the joints and the cables by region. `number(node)`: region of the joints and cables that act on `node`.
/// Returns the number of regions, including regions that have no contacts.
template <class Number>
Index collect_connections(const NodeGroups& groups, std::span<const Real> inverse_mass, const Number& number,
                          Index region_count, RegionTable& regions) {
    const std::size_t joints = groups.joints.size(), cables = groups.cables.block.size();
    regions.joints.clear();
    regions.cables.clear();
    const auto region_of_node = [&](Index node) { return groups.is_on_other_rank(node) ? no_index : number(node); };
    const auto region_of_joint = [&](std::size_t j) { return region_of_node(groups.node_of_joint(j)); };
    const auto region_of_cable = [&](std::size_t c) { return region_of_node(groups.node_of_cable(c, inverse_mass)); };
    for (std::size_t j = 0; j < joints; ++j) region_count = std::max(region_count, region_of_joint(j) + 1);
    for (std::size_t c = 0; c < cables; ++c) region_count = std::max(region_count, region_of_cable(c) + 1);
    if (joints > 0) collect(joints, region_of_joint, region_count, regions.joints);
    if (cables > 0) collect(cables, region_of_cable, region_count, regions.cables);
    return region_count;
}

/// Separates regions sequentially, for few contacts or few workers. separate_in_blocks gives bitwise the same result.
Index separate_in_order(std::span<const Stencil> stencil, std::span<const Real> inverse_mass, const NodeGroups& groups,
                        UnionFind& sets, RegionTable& regions, std::span<Index> contact_region) {
    const Index count =
        groups.empty()
            ? label_by_union_find(
                  stencil, inverse_mass, [](Index node) { return node; }, groups, sets, contact_region)
            : label_by_union_find(
                  stencil, inverse_mass, [&](Index node) { return groups.leader(node); }, groups, sets, contact_region);
    const Index all = collect_connections(
        groups, inverse_mass, [&](Index node) { return sets.number(node); }, count, regions);
    collect_contacts(contact_region, all, regions);
    return all;
}

Index separate_in_blocks(Executor& executor, std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                         const NodeGroups& groups, BlockLabels& labels, RegionTable& regions,
                         std::span<Index> contact_region) {
    const Index count =
        label_in_blocks(executor, stencil, inverse_mass, groups, labels, regions.contacts, contact_region);
    // A set of nodes in labels.sets is identified by its first contact (first_item). A set without contacts, which
    // joints or cables connect, gets a number above all contact indices, in the order in which these sets are met.
    // Their regions follow the regions with contacts.
    const Index contacts = static_cast<Index>(stencil.size());
    Index item = contacts;
    const auto number = [&](Index node) {
        const Index root = labels.sets.root(node);
        if (labels.sets.first_item(root) == no_index) labels.sets.begin_with(root, item++);
        const Index first = labels.sets.first_item(root);
        return first < contacts ? contact_region[static_cast<std::size_t>(first)] : count + first - contacts;
    };
    const Index all = collect_connections(groups, inverse_mass, number, count, regions);
    regions.contacts.offset.resize(static_cast<std::size_t>(all) + 1, regions.contacts.offset[count]);
    return all;
}

Index make_single_region(std::span<const Stencil> stencil, std::span<const Real> inverse_mass, const NodeGroups& groups,
                         RegionTable& regions, std::span<Index> contact_region) {
    const Index count = label_single_region(stencil, inverse_mass, contact_region);
    const Index all = collect_connections(
        groups, inverse_mass, [](Index) { return 0; }, count, regions);
    collect_contacts(contact_region, all, regions);
    return all;
}

void resize_results(Index region_count, RegionTable& regions) {
    const std::size_t count = static_cast<std::size_t>(region_count);
    regions.iterations.assign(count, 0);
    regions.error.assign(count, 0);
    regions.status.assign(count, RegionStatus::converged);
    regions.shortcut.assign(count, shortcut_none);
    regions.dissipated.assign(count, 0);
    regions.push_work.assign(count, 0);
    regions.order.assign(count, 0);
}

}  // namespace

bool separate_regions(Executor& executor, std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                      const NodeGroups& groups, ContactRegions mode, SeparationMemory& memory, RegionTable& regions,
                      std::span<Index> contact_region) {
    SKERRY_CHECK(contact_region.size() == stencil.size());
    if (stencil.empty() && groups.joints.empty() && groups.cables.block.empty()) {
        regions.contacts.clear();
        regions.joints.clear();
        regions.cables.clear();
        resize_results(0, regions);
        return false;
    }
    const bool in_blocks =
        stencil.size() >= least_contacts_in_blocks && executor.worker_count() >= least_workers_for_blocks;
    Index region_count = 0;
    switch (mode) {
        case ContactRegions::separate:
            region_count = in_blocks
                               ? separate_in_blocks(executor, stencil, inverse_mass, groups, memory.labels, regions,
                                                    contact_region)
                               : separate_in_order(stencil, inverse_mass, groups, memory.sets, regions, contact_region);
            break;
        case ContactRegions::global:
            region_count = make_single_region(stencil, inverse_mass, groups, regions, contact_region);
            break;
    }
    resize_results(region_count, regions);
    return true;
}

}  // namespace skerry
