#include "systems/solver/regions/region_stage.h"

#include <algorithm>
#include <cmath>

namespace skerry {

void RegionMemory::make_room_for(std::size_t contacts, std::size_t region_nodes, std::size_t nodes,
                                 const SolverSettings& settings) {
    make_room(contact, contacts);
    make_room(impulse, contacts);
    make_room(push_impulse, contacts);
    make_room(push_bias, contacts);
    make_room(node, region_nodes);
    make_room(velocity, region_nodes);
    make_room(scratch, region_nodes);
    make_room(node_index, nodes);
    for (std::size_t slot = 0; slot < workspace_slots(settings.method); ++slot) make_room(workspace[slot], contacts);
}

RegionOutcome outcome_of(const SolveResult& result, const SolverSettings& settings) {
    const bool converged = result.converged || result.error <= settings.tolerance;
    RegionStatus status = converged ? RegionStatus::converged : RegionStatus::iteration_limit;
    if (!std::isfinite(result.error)) status = RegionStatus::not_finite;
    return {.iterations = result.iterations, .error = result.error, .status = status};
}

void write_outcome(const RegionOutcome& outcome, Index number, RegionTable& regions) {
    regions.iterations[number] = outcome.iterations;
    regions.error[number] = outcome.error;
    regions.status[number] = outcome.status;
    regions.shortcut[number] = outcome.shortcut;
    regions.dissipated[number] = outcome.dissipated;
    regions.push_work[number] = outcome.push_work;
}

SolveLimits limits_of(const SolverSettings& settings, Real tolerance) {
    return {tolerance, settings.max_iterations, settings.fixed_iterations, settings.relaxation};
}

Real tolerance_of(const RegionStage& stage, std::span<const Index> row) {
    const RegionInputs& inputs = stage.inputs;
    const SolverSettings& settings = stage.settings;
    if (!(settings.still_tolerance < settings.tolerance) || inputs.still_time.empty()) return settings.tolerance;
    // A mesh collider has no still time and counts as still even if it moves. Bodies that it carries move too, so their
    // still time is zero.
    const auto is_still = [&](Index body) {
        return body == no_index || inputs.body_kind[body] == BodyKind::kinematic || inputs.still_time[body] > 0;
    };
    const bool all = std::ranges::all_of(
        row, [&](Index i) { return is_still(inputs.first_body[i]) && is_still(inputs.second_body[i]); });
    return all ? settings.still_tolerance : settings.tolerance;
}

ContactMemory memory_from(const RegionStage& stage, Index base, std::size_t count, std::size_t first_node,
                          std::span<const Index> node, std::size_t slots) {
    RegionMemory& data = stage.memory;
    const std::size_t first = static_cast<std::size_t>(base);
    ContactMemory memory{.contact = data.contact.span().subspan(first, count),
                         .impulse = data.impulse.span().subspan(first, count),
                         .velocity = data.velocity.span().subspan(first_node, node.size()),
                         .node = node,
                         .scratch = data.scratch.span().subspan(first_node, node.size()),
                         .workspace = {}};
    for (std::size_t slot = 0; slot < slots; ++slot)
        memory.workspace[slot] = data.workspace[slot].span().subspan(first, count);
    return memory;
}

PushMemory push_memory(const RegionStage& stage, Index base, std::size_t count) {
    const std::size_t first = static_cast<std::size_t>(base);
    return {stage.memory.push_impulse.span().subspan(first, count),
            stage.memory.push_bias.span().subspan(first, count)};
}

Real dissipated_by(const RegionStage& stage, Index row) {
    const Vec3& impulse = stage.out.impulse[row];
    if (impulse.isZero(0)) return 0;
    const Stencil& stencil = stage.inputs.stencil[row];
    Vec3 velocity_sum = -2 * stage.inputs.surface_velocity[row];
    for (std::size_t a = 0; a < 4; ++a)
        if (stencil.weight[a] != 0)
            velocity_sum +=
                stencil.weight[a] * (stage.inputs.velocity[stencil.node[a]] + stage.out.velocity_next[stencil.node[a]]);
    return -0.5 * impulse.dot(velocity_sum);
}

Real push_work_of_nodes(const RegionStage& stage, const ContactMemory& memory, bool own_masses) {
    const auto cluster_of = [&](Index node) {
        return stage.inputs.clustered() ? stage.inputs.clusters->cluster(node) : no_index;
    };
    const std::span<const Vec4> push = memory.scratch;
    Real work = 0;
    for (std::size_t i = 0; i < memory.contact.size(); ++i) {
        const LumpedContact& contact = memory.contact[i];
        if (own_masses) {
            work += memory.impulse[i].dot(add_node_velocities(contact, push.data(), Vec4::Zero()));
            continue;
        }
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a)
            if (cluster_of(memory.node[contact.node[a]]) == no_index)
                work += contact.weight[a] * memory.impulse[i].dot(push[contact.node[a]]);
    }
    for (std::size_t n = 0; n < memory.node.size(); ++n) {
        const Index node = memory.node[n];
        if (node == no_index) continue;
        const Index cluster = own_masses ? no_index : cluster_of(node);
        const Vec3 moved = push[n].head<3>();
        if (cluster == no_index)
            work -= (memory.velocity[n].head<3>() - stage.inputs.velocity[node]).dot(moved) /
                    stage.inputs.inverse_mass[node];
        else
            work -= stage.inputs
                        .cluster_kick[stage.inputs.clusters->nodes.offset[cluster] +
                                      stage.inputs.clusters->index_in_cluster[node]]
                        .dot(moved);
    }
    return work;
}

}  // namespace skerry
