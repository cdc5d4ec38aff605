// Limits of the step length that depend on the bodies of all ranks.
#include <algorithm>
#include <cstddef>

#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Limits that follow from the tables of this rank. Model::of_ranks must have its initial value, because stable_step()
/// also applies the limits in it.
LimitsOfRanks limits_of_rank(const WorldState& world) {
    const Model& model = world.model;
    LimitsOfRanks limits;
    Index stiffest = no_index;
    limits.stable_step = stable_step(model, &stiffest);
    limits.stiffest = stiffest == no_index ? RankFindings::nobody : world.ranks.world_row_of(stiffest);
    limits.strained = stiffest != no_index && is_strained(model, static_cast<std::size_t>(stiffest));
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        if (!world.ranks.owns(b) || model.bodies.blocks[b].size() == 0) continue;
        limits.rest_step = std::min(limits.rest_step, model.bodies.rest_step[b]);
        limits.element_blocks += static_cast<std::uint64_t>(model.bodies.blocks[b].size());
    }
    for (std::size_t c = 0; c < model.clusters.size(); ++c)
        if (world.ranks.owns(static_cast<std::size_t>(model.clusters.body[c])))
            limits.cluster_entries += model.clusters.nodes[c].size() * model.clusters.nodes[c].size();
    Index spinning = no_index;
    limits.spin = fastest_spin(model, &spinning);
    limits.spinning = spinning == no_index ? RankFindings::nobody : world.ranks.world_row_of(spinning);
    limits.has_frames = model.rigid_bodies.size() > 0;
    limits.has_implicit = model.implicit_nodes.size() > 0;
    limits.has_clusters = !model.clusters.empty();
    limits.forced = model.forced;
    limits.follow_implicit = forces_follow_implicit_bodies(model);
    limits.clusters_grew = model.clusters_grew;
    limits.moves = model.force_rate_moves || model.joints.slot.size() > 0 || model.ties.size() > 0;
    return limits;
}

void combine_limits(LimitsOfRanks& into, const LimitsOfRanks& from) {
    if (from.stable_step < into.stable_step ||
        (from.stable_step == into.stable_step && from.stiffest < into.stiffest)) {
        into.stable_step = from.stable_step;
        into.stiffest = from.stiffest;
        into.strained = from.strained;
    }
    into.rest_step = std::min(into.rest_step, from.rest_step);
    if (from.spin > into.spin || (from.spin == into.spin && from.spinning < into.spinning)) {
        into.spin = from.spin;
        into.spinning = from.spinning;
    }
    into.has_frames |= from.has_frames;
    into.has_implicit |= from.has_implicit;
    into.has_clusters |= from.has_clusters;
    into.forced |= from.forced;
    into.follow_implicit |= from.follow_implicit;
    into.clusters_grew |= from.clusters_grew;
    into.element_blocks += from.element_blocks;
    into.cluster_entries += from.cluster_entries;
    into.moves |= from.moves;
}

void take_faster(StrainRate& into, const StrainRate& from) {
    if (from.rate > into.rate || (from.rate == into.rate && from.body < into.body)) into = from;
}

}  // namespace

void reduce_limits(WorldState& world) {
    if (!world.ranks.on()) return;
    Model& model = world.model;
    model.of_ranks = {};
    LimitsOfRanks limits = limits_of_rank(world);
    reduce<combine_limits>(*world.ranks.ranks, limits);
    for (Index* body : {&limits.stiffest, &limits.spinning})
        if (*body == RankFindings::nobody) *body = no_index;
    model.of_ranks = limits;
    // If any rank has force elements, all ranks add applied forces to all nodes, as an undivided world does. Code with
    // and without these forces rounds differently.
    model.forced |= limits.forced;
    if (limits.clusters_grew) world.ranks.pieces_before.clear();
    model.clusters_grew = false;
}

StrainRate fastest_of_ranks(WorldState& world, const StrainRate& own) {
    if (!world.ranks.on()) return own;
    StrainRate fastest{own.rate, own.body == no_index ? RankFindings::nobody : world.ranks.world_row_of(own.body)};
    reduce<take_faster>(*world.ranks.ranks, fastest);
    return {fastest.rate, fastest.body == RankFindings::nobody ? no_index : fastest.body};
}

}  // namespace skerry
