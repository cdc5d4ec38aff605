// Regions of contacts between nodes with lumped masses. Nodes have their own mass or belong to clusters.
#pragma once

#include <type_traits>

#include "systems/solver/local/load_contact.h"
#include "systems/solver/operators/lumped_operator.h"
#include "systems/solver/regions/life_cycle.h"

namespace skerry {

template <RegionTraversal Traversal>
using LumpedRegion = LoadedRegion<Traversal, LumpedMemory>;

template <RegionTraversal Traversal>
LumpedOperatorBy<Traversal> operator_of(const RegionStage& stage, const LumpedRegion<Traversal>& region) {
    return {region.memory, stage.settings.friction, region.scale, region.traversal};
}

/// Returns a region whose contacts are not loaded yet. `node` lists rows of NodeTable; the region's entries in the
/// columns by node begin at `first_node`.
template <RegionTraversal Traversal>
LumpedRegion<Traversal> lumped_region(const RegionStage& stage, std::span<const Index> row, Index base,
                                      std::size_t first_node, std::span<const Index> node, const Traversal& traversal) {
    const std::size_t slots = workspace_slots(stage.settings.method);
    return {.row = row,
            .base = base,
            .traversal = traversal,
            .memory = {memory_from(stage, base, row.size(), first_node, node, slots), stage.out.velocity_next},
            .tolerance = tolerance_of(stage, row)};
}

/// Loads the contacts of a region. `numbering(k)` returns a function from the moving nodes of contact k to their rows
/// in the region. When this function returns a row, region.memory.velocity must already contain its velocity.
template <RegionTraversal Traversal, class Numbering>
void load_lumped_contacts(const RegionStage& stage, LumpedRegion<Traversal>& region, Numbering&& numbering) {
    // The lane solver needs the contact velocities without impulses.
    const bool keep_free_velocity = std::is_same_v<Traversal, InOrder> && workspace_slots(stage.settings.method) > 1;
    const std::size_t first = static_cast<std::size_t>(region.base);
    const Vec4* velocity = region.memory.velocity.data();
    load_contacts(stage, region, [&](std::size_t position, std::size_t number, LumpedContact& contact) {
        contact = load_contact(stage.inputs, region.row[number], stage.out.velocity_next, stage.settings, stage.h,
                               numbering(number));
        if constexpr (!Traversal::own_masses) {
            if (contact.node_count > 0) {
                contact.diagonal = region.traversal.coupling(contact, contact);
                contact.inverse_diagonal = 1 / contact.diagonal;
            }
        }
        const Vec4 u = contact_velocity(contact, velocity);
        if (keep_free_velocity) stage.memory.workspace[free_velocity_slot][first + position] = u;
        return u;
    });
}

/// Loads a region for one thread. New nodes are added to the end of `list`.
template <RegionTraversal Traversal>
void load_listed(const RegionStage& stage, NodeList& list, LumpedRegion<Traversal>& region) {
    const auto local = [&](Index node) { return list.index_of(node, [&] { return free_velocity_of(stage, node); }); };
    load_lumped_contacts(
        stage, region, [&](std::size_t) -> const auto& { return local; });
    list.trim(region.memory);
}

}  // namespace skerry
