#include "systems/contact/separate_regions.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "components/check.h"
#include "systems/contact/algorithm_1.h"

namespace skerry {
namespace {

/// Joins the moving nodes of a contact, each with its group: `leader(node)` stands for that. Returns their root, or
/// no_index.
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

/// Numbers the regions by their first contact.
template <class Leader>
Index label_by_union_find(std::span<const Stencil> stencil, std::span<const Real> inverse_mass, const Leader& leader,
                          std::span<const JointBlock> joints, UnionFind& sets, std::span<Index> contact_region) {
    sets.start(inverse_mass.size());
    for (const JointBlock& joint : joints)
        if (joint.first_node != no_index && joint.second_node != no_index)
            sets.join(joint.first_node, joint.second_node);
    constexpr std::size_t ahead = 12;  // contacts: by then their nodes have come from the memory
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
    for (std::size_t i = 0; i < contact_region.size(); ++i) {
        if (i + ahead < contact_region.size() && contact_region[i + ahead] != no_index)
            sets.fetch(contact_region[i + ahead]);
        if (contact_region[i] != no_index) contact_region[i] = sets.number(contact_region[i]);
    }
    return sets.number_count;
}

Index label_all_as_one(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                       std::span<Index> contact_region) {
    bool any = false;
    for (std::size_t i = 0; i < stencil.size(); ++i) {
        const bool moves = has_moving_node(stencil[i], inverse_mass);
        contact_region[i] = moves ? 0 : no_index;
        any |= moves;
    }
    return any ? 1 : 0;
}

/// Counting sort of `count` contacts or joints by region: stable, so a region holds its contacts in contact order.
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
    // the fill has moved each offset to the start of the next region: move them back
    for (Index r = region_count; r > 0; --r) offset[r] = offset[r - 1];
    offset[0] = 0;
}

void collect_contacts(std::span<const Index> contact_region, Index region_count, RegionTable& regions) {
    collect(
        contact_region.size(), [&](std::size_t i) { return contact_region[i]; }, region_count, regions.contacts);
}

/// With regions of their own where no contact touches what they join. Returns how many regions there are.
Index collect_joints(std::span<const JointBlock> joints, bool all_as_one, UnionFind& sets, Index region_count,
                     Ragged<Index>& list) {
    list.clear();
    if (joints.empty()) return region_count;
    const auto region_of = [&](std::size_t i) {
        const JointBlock& joint = joints[i];
        return all_as_one ? 0 : sets.number(joint.first_node == no_index ? joint.second_node : joint.first_node);
    };
    Index count = all_as_one ? 1 : region_count;
    for (std::size_t i = 0; i < joints.size(); ++i) count = std::max(count, region_of(i) + 1);
    collect(joints.size(), region_of, count, list);
    return count;
}

void resize_results(Index region_count, RegionTable& regions) {
    const std::size_t count = static_cast<std::size_t>(region_count);
    regions.iterations.assign(count, 0);
    regions.error.assign(count, 0);
    regions.status.assign(count, RegionStatus::converged);
    regions.shortcut.assign(count, shortcut_none);
    regions.frozen.assign(count, 0);
    regions.dissipated.assign(count, 0);
    regions.push_work.assign(count, 0);
    regions.order.assign(count, 0);
}

}  // namespace

bool separate_regions(std::span<const Stencil> stencil, std::span<const Real> inverse_mass, const NodeGroups& groups,
                      ContactRegions mode, UnionFind& memory, RegionTable& regions, std::span<Index> contact_region) {
    SKERRY_CHECK(contact_region.size() == stencil.size());
    regions.independent = true;
    if (stencil.empty() && groups.joints.empty()) {
        regions.contacts.clear();
        regions.joints.clear();
        resize_results(0, regions);
        return false;
    }
    Index region_count = 0;
    switch (mode) {
        case ContactRegions::separate:
            region_count = groups.empty()
                               ? label_by_union_find(
                                     stencil, inverse_mass, [](Index node) { return node; }, {}, memory, contact_region)
                               : label_by_union_find(
                                     stencil, inverse_mass, [&](Index node) { return groups.leader(node); },
                                     groups.joints, memory, contact_region);
            break;
        case ContactRegions::global:
            region_count = label_all_as_one(stencil, inverse_mass, contact_region);
            break;
        case ContactRegions::paper_algorithm_1:
            region_count = label_by_algorithm_1(stencil, inverse_mass, contact_region);
            break;
    }
    region_count = collect_joints(groups.joints, mode == ContactRegions::global, memory, region_count, regions.joints);
    collect_contacts(contact_region, region_count, regions);
    resize_results(region_count, regions);
    if (mode == ContactRegions::paper_algorithm_1)  // which looks at nodes alone: regions may share groups of them
        regions.independent = groups.empty() && count_shared_nodes(stencil, inverse_mass, regions) == 0;
    return true;
}

Index count_shared_nodes(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                         const RegionTable& regions) {
    std::vector<std::pair<Index, Index>> node_region;
    for (std::size_t r = 0; r < regions.size(); ++r)
        for (const Index contact : regions.contacts[r])
            for (std::size_t a = 0; a < 4; ++a)
                if (stencil[contact].weight[a] != 0 && inverse_mass[stencil[contact].node[a]] > 0)
                    node_region.emplace_back(stencil[contact].node[a], static_cast<Index>(r));
    std::sort(node_region.begin(), node_region.end());
    node_region.erase(std::unique(node_region.begin(), node_region.end()), node_region.end());
    std::set<std::pair<Index, Index>> pairs;
    for (std::size_t i = 0; i < node_region.size(); ++i)
        for (std::size_t j = i + 1; j < node_region.size() && node_region[j].first == node_region[i].first; ++j)
            pairs.emplace(node_region[i].second, node_region[j].second);
    return static_cast<Index>(pairs.size());
}

}  // namespace skerry
