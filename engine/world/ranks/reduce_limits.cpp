// Limits of the step length that depend on the bodies of all ranks.
#include <algorithm>
#include <cstddef>
#include <cstring>

#include "engine/world/step/step.h"

namespace skerry {

void reduce_limits(WorldState& world) {
    if (!world.ranks.on()) return;
    Model& model = world.model;
    LimitsOfRanks limits;
    model.of_ranks = limits;
    Index stiffest = no_index;
    limits.stable_step = stable_step(model, &stiffest);
    limits.stiffest = stiffest == no_index ? RankFindings::nobody : world.ranks.place_of(stiffest);
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
    limits.spinning = spinning == no_index ? RankFindings::nobody : world.ranks.place_of(spinning);
    limits.has_frames = model.rigid_bodies.size() > 0;
    limits.has_implicit = model.implicit_nodes.size() > 0;
    limits.has_clusters = !model.clusters.empty();
    limits.forced = model.forced;
    limits.follow_implicit = forces_follow_implicit_bodies(model);
    limits.clusters_grew = model.clusters_grew;
    limits.moves = model.force_rate_moves || model.joints.slot.size() > 0 || model.ties.size() > 0;
    reduce(*world.ranks.ranks, limits, [](std::byte* into, const std::byte* from) {
        LimitsOfRanks all, other;
        std::memcpy(&all, into, sizeof all);
        std::memcpy(&other, from, sizeof other);
        if (other.stable_step < all.stable_step ||
            (other.stable_step == all.stable_step && other.stiffest < all.stiffest)) {
            all.stable_step = other.stable_step;
            all.stiffest = other.stiffest;
            all.strained = other.strained;
        }
        all.rest_step = std::min(all.rest_step, other.rest_step);
        if (other.spin > all.spin || (other.spin == all.spin && other.spinning < all.spinning)) {
            all.spin = other.spin;
            all.spinning = other.spinning;
        }
        all.has_frames |= other.has_frames;
        all.has_implicit |= other.has_implicit;
        all.has_clusters |= other.has_clusters;
        all.forced |= other.forced;
        all.follow_implicit |= other.follow_implicit;
        all.clusters_grew |= other.clusters_grew;
        all.element_blocks += other.element_blocks;
        all.cluster_entries += other.cluster_entries;
        all.moves |= other.moves;
        std::memcpy(into, &all, sizeof all);
    });
    for (Index* place : {&limits.stiffest, &limits.spinning})
        if (*place == RankFindings::nobody) *place = no_index;
    model.of_ranks = limits;
    // Force elements anywhere in the world change the rounding of all bodies, so all ranks must know of them.
    model.forced |= limits.forced;
    if (limits.clusters_grew) world.ranks.pieces_before.clear();
    model.clusters_grew = false;
}

StrainRate fastest_of_ranks(WorldState& world, const StrainRate& mine) {
    if (!world.ranks.on()) return mine;
    StrainRate all{mine.rate, mine.body == no_index ? RankFindings::nobody : world.ranks.place_of(mine.body)};
    reduce(*world.ranks.ranks, all, [](std::byte* into, const std::byte* from) {
        StrainRate fastest, other;
        std::memcpy(&fastest, into, sizeof fastest);
        std::memcpy(&other, from, sizeof other);
        if (other.rate > fastest.rate || (other.rate == fastest.rate && other.body < fastest.body)) fastest = other;
        std::memcpy(into, &fastest, sizeof fastest);
    });
    return {all.rate, all.body == RankFindings::nobody ? no_index : all.body};
}

}  // namespace skerry
