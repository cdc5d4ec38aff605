#include "systems/solver/regions/solve_region.h"

#include <array>
#include <cmath>

#include "systems/solver/operators/normal_rows.h"

namespace skerry {
namespace {

/// Solves a frictionless region by sweeps on the normal impulses.
SolveResult solve_frictionless(const RegionStage& stage, const RegionInOrder& region) {
    const PushMemory memory = push_memory(stage, region.base, region.row.size());
    NormalRows rows(region.memory, region.scale, {memory.impulse, memory.bias});
    const SolveResult result = solve_ags(rows, limits_of(stage.settings, region.tolerance));
    // If solve_ags has not converged, it has already written its best impulses to region.memory. `rows` then holds
    // later and worse impulses.
    if (result.converged || !std::isfinite(result.error)) rows.keep();
    return result;
}

}  // namespace

RegionInOrder load_region(const RegionStage& stage, std::span<const Index> row, Index base) {
    const std::size_t first_node = 4 * static_cast<std::size_t>(base);
    NodeList list(stage.memory, first_node, 4 * row.size());
    RegionInOrder region = lumped_region(stage, row, base, first_node, list.node(), InOrder{});
    load_listed(stage, list, region);
    return region;
}

RegionOutcome sweep_in_order(const RegionStage& stage, const RegionInOrder& region, LumpedOperator& op) {
    const SolverSettings& settings = stage.settings;
    if (!region.sums.frictionless || !settings.frictionless_rows || !sweeps_accelerated(settings))
        return sweep_region(stage, region, op);
    RegionOutcome outcome = outcome_of(solve_frictionless(stage, region), settings);
    outcome.shortcut = shortcut_frictionless;
    return outcome;
}

RegionOutcome solve_single(const RegionStage& stage, Index row, Index base) {
    std::array<Index, 4> node;
    std::array<Vec4, 4> velocity, push_velocity;
    std::size_t node_count = 0;
    const LumpedContact contact =
        load_contact(stage.inputs, row, stage.out.velocity_next, stage.settings, stage.h, [&](Index global) {
            // A node that occurs twice in the stencil must be counted once.
            for (std::size_t n = 0; n < node_count; ++n)
                if (node[n] == global) return static_cast<Index>(n);
            node[node_count] = global;
            velocity[node_count] = free_velocity_of(stage, global);
            return static_cast<Index>(node_count++);
        });
    Vec4 impulse = Vec4::Zero();
    const Real size = solve_contact(contact, stage.settings.friction, 1, velocity.data(), impulse);
    RegionOutcome outcome{.iterations = 1, .shortcut = shortcut_closed_form};
    if (!std::isfinite(size)) {
        outcome.status = RegionStatus::not_finite;
        outcome.error = size;
    }
    const RegionInOrder region{.row = {&row, 1},
                               .base = base,
                               .memory = {{.contact = {&contact, 1},
                                           .impulse = {&impulse, 1},
                                           .velocity = {velocity.data(), node_count},
                                           .node = {node.data(), node_count},
                                           .scratch = {push_velocity.data(), node_count},
                                           .workspace = {}},
                                          {}}};
    finish_region(stage, region, operator_of(stage, region), outcome);
    return outcome;
}

template bool start_region(const RegionStage&, const RegionInOrder&, LumpedOperator&, RegionOutcome&);

}  // namespace skerry
