#include "systems/solver/solve_region.h"

#include <algorithm>
#include <cmath>

#include "systems/solver/methods/run_method.h"
#include "systems/solver/methods/solve_frictionless.h"
#include "systems/solver/operators/load_sums.h"
#include "systems/solver/push_out_region.h"

namespace skerry {
namespace {

void take_warm_start(const RegionStage& stage, const LoadedRegion& region) {
    const LumpedOperator::Memory& memory = region.memory;
    for (std::size_t k = 0; k < region.row.size(); ++k) {
        if (memory.contact[k].node_count == 0) continue;
        memory.impulse[k] = warm_impulse(memory.contact[k], stage.out.impulse[region.row[k]]);
        apply_impulse(memory.contact[k], memory.impulse[k], memory.velocity.data());
    }
}

/// Whether the method is solve_ags, which the shortcuts have in forms of their own.
bool accelerated(const SolverSettings& settings) {
    return (settings.method == SolverMethod::ags || settings.method == SolverMethod::automatic) && !settings.fixed_iterations;
}

/// Lets contacts rest whose change is worth no more than a tenth of their share of the tolerance (methods.md 2.7).
void allow_freezing(const RegionStage& stage, LoadedRegion& region) {
    const SolverSettings& settings = stage.settings;
    if (!settings.freeze_contacts || settings.fixed_iterations) return;
    const std::size_t first = static_cast<std::size_t>(region.base), count = region.row.size();
    const Real share = 0.1 * settings.tolerance * region.scale;
    region.memory.still = share * share / static_cast<Real>(count);
    region.memory.resting = stage.memory.resting.span().subspan(first, count);
    region.memory.last_velocity = stage.memory.last_velocity.span().subspan(first, count);
    std::fill(region.memory.resting.begin(), region.memory.resting.end(), LumpedOperator::velocity_unknown);
}

/// What is left to do after impulses were put back into their cones: nothing, as a rule.
SolveResult without_freezing(LoadedRegion& region, const SolverSettings& settings, SolveLimits limits, LumpedOperator& op,
                             SolveResult result) {
    result.error = op.error();
    if (!result.converged || result.error <= limits.tolerance) return result;
    region.memory.resting = {};
    LumpedOperator awake(region.memory, settings.friction, region.scale);
    limits.max_iterations = std::max(Index{1}, limits.max_iterations - result.iterations);
    const SolveResult rest = run_method(settings.method, awake, limits);
    return {result.iterations + rest.iterations, rest.error, rest.converged};
}

/// Writes impulses and velocities, and returns what the region dissipated.
Real write_back(const RegionStage& stage, std::span<const Index> row, const LumpedOperator::Memory& memory) {
    for (std::size_t k = 0; k < row.size(); ++k) stage.out.impulse[row[k]] = memory.impulse[k].head<3>();
    for (std::size_t n = 0; n < memory.node.size(); ++n) stage.out.velocity_next[memory.node[n]] = memory.velocity[n].head<3>();
    Real dissipated = 0;
    for (const Index i : row) dissipated += dissipated_by(stage, i);
    return dissipated;
}

void write_push(const RegionStage& stage, std::span<const Index> node, std::span<const Vec4> push) {
    for (std::size_t n = 0; n < node.size(); ++n) stage.out.push_out[node[n]] = push[n].head<3>();
    stage.memory.pushed.store(true, std::memory_order_relaxed);
}

}  // namespace

// A node's place in the list is remembered by node; regions share no moving node, so none overwrites what another needs, and an entry
// left from elsewhere shows by the list not agreeing.
LoadedRegion load_region(const RegionStage& stage, std::span<const Index> row, Index base) {
    SolverMemory::Data& data = stage.memory;
    const std::size_t first = static_cast<std::size_t>(base), count = row.size();
    const std::span<Index> node = data.node.span().subspan(4 * first, 4 * count);
    const std::span<Vec4> velocity = data.velocity.span().subspan(4 * first, 4 * count);
    std::size_t node_count = 0;
    const auto local = [&](Index global) {
        Index& place = data.place[global];
        if (static_cast<std::size_t>(place) < node_count && node[place] == global) return place;
        place = static_cast<Index>(node_count);
        node[node_count] = global;
        velocity[node_count++] = padded(stage.out.velocity_next[global]);
        return place;
    };
    LoadedRegion region{.row = row, .base = base, .memory = {}};
    const bool keep_free_velocity = workspace_slots(stage.settings.method) > 1;
    LoadSums sums;
    for (std::size_t k = 0; k < count; ++k) {
        LumpedContact& contact = data.contact[first + k];
        contact = load_contact(stage.inputs, row[k], stage.out.velocity_next, stage.settings, stage.h, local);
        const Vec4 u = contact_velocity(contact, velocity.data());
        sums.add(contact, stage.settings.friction, u);
        region.frictionless &= contact.friction.stick == 0;
        region.one_friction &= contact.friction.stick == contact.friction.slide;
        data.impulse[first + k].setZero();
        if (keep_free_velocity) data.workspace[free_velocity_slot][first + k] = u;
    }
    region.separate = sums.separate;
    region.scale = error_scale(sums, stage.inputs.gravity, stage.h, stage.settings.tolerance);
    region.memory.contact = data.contact.span().subspan(first, count);
    region.memory.impulse = data.impulse.span().subspan(first, count);
    region.memory.velocity = velocity.first(node_count);
    region.memory.node = node.first(node_count);
    region.memory.free_velocity = stage.out.velocity_next;
    region.memory.scratch = data.scratch.span().subspan(4 * first, node_count);
    for (std::size_t slot = 0; slot < workspace_slots(stage.settings.method); ++slot)
        region.memory.workspace[slot] = data.workspace[slot].span().subspan(first, count);
    return region;
}

bool start_region(const RegionStage& stage, LoadedRegion& region, RegionOutcome& outcome) {
    const SolverSettings& settings = stage.settings;
    if (settings.fixed_iterations) {
        // Where nothing moves zero is the solution, and what sweeps leave of another start has no scale to be compared with. What only
        // separates starts from its impulses, too: what a sweep does must not depend on how regions are cut.
        if (settings.warm_start == WarmStart::on && region.scale > 0) take_warm_start(stage, region);
        return false;
    }
    if (region.separate && settings.skip_separating) {
        outcome = {.status = RegionStatus::certified, .shortcut = shortcut_separating};
        return true;
    }
    if (settings.warm_start == WarmStart::off) return false;
    take_warm_start(stage, region);
    LumpedOperator op(region.memory, settings.friction, region.scale);
    return start_from_warm_impulse(op, settings, outcome);
}

RegionOutcome sweep_region(const RegionStage& stage, LoadedRegion& region) {
    const SolverSettings& settings = stage.settings;
    const SolveLimits limits{settings.tolerance, settings.max_iterations, settings.fixed_iterations, settings.relaxation};
    RegionOutcome outcome;
    SolveResult result;
    if (region.frictionless && settings.frictionless_rows && accelerated(settings)) {
        const std::size_t first = static_cast<std::size_t>(region.base), count = region.row.size();
        result = solve_frictionless(
            region.memory, region.scale, limits,
            {stage.memory.push_impulse.span().subspan(first, count), stage.memory.push_bias.span().subspan(first, count)});
        outcome.shortcut = shortcut_frictionless;
    } else {
        allow_freezing(stage, region);
        LumpedOperator op(region.memory, settings.friction, region.scale);
        result = run_method(settings.method, op, limits);
        outcome.frozen = op.frozen();
        if (op.frozen() > 0 && op.make_feasible()) result = without_freezing(region, settings, limits, op, result);
    }
    outcome.iterations = result.iterations;
    outcome.error = result.error;
    outcome.status = result.converged ? RegionStatus::converged : RegionStatus::iteration_limit;
    if (!std::isfinite(result.error)) outcome.status = RegionStatus::not_finite;
    return outcome;
}

void finish_region(const RegionStage& stage, const LoadedRegion& region, RegionOutcome& outcome) {
    const LumpedOperator::Memory& memory = region.memory;
    outcome.dissipated = write_back(stage, region.row, memory);
    if (outcome.status == RegionStatus::not_finite) return;
    const std::size_t first = static_cast<std::size_t>(region.base), count = region.row.size();
    const PushMemory push{stage.memory.push_impulse.span().subspan(first, count), stage.memory.push_bias.span().subspan(first, count),
                          stage.memory.scratch.span().subspan(4 * first, memory.node.size())};
    if (push_out_region(memory.contact, region.row, stage.inputs.gap, memory.velocity, stage.inputs.gravity, stage.settings, stage.h, push))
        write_push(stage, memory.node, push.velocity);
}

Real dissipated_by(const RegionStage& stage, Index row) {
    const Vec3& impulse = stage.out.impulse[row];
    if (impulse.isZero(0)) return 0;
    const Stencil& stencil = stage.inputs.stencil[row];
    Vec3 twice_mean = -2 * stage.inputs.surface_velocity[row];
    for (std::size_t a = 0; a < 4; ++a)
        if (stencil.weight[a] != 0)
            twice_mean += stencil.weight[a] * (stage.inputs.velocity[stencil.node[a]] + stage.out.velocity_next[stencil.node[a]]);
    return -0.5 * impulse.dot(twice_mean);
}

RegionOutcome solve_single(const RegionStage& stage, Index row) {
    std::array<Index, 4> node;
    std::array<Vec4, 4> velocity, push_velocity;
    std::size_t node_count = 0;
    const LumpedContact contact = load_contact(stage.inputs, row, stage.out.velocity_next, stage.settings, stage.h, [&](Index global) {
        // a stencil may name a node twice
        for (std::size_t n = 0; n < node_count; ++n)
            if (node[n] == global) return static_cast<Index>(n);
        node[node_count] = global;
        velocity[node_count] = padded(stage.out.velocity_next[global]);
        return static_cast<Index>(node_count++);
    });
    Vec4 impulse = Vec4::Zero();
    const Real size = solve_contact(contact, stage.settings.friction, 1, velocity.data(), impulse);
    const LumpedOperator::Memory memory{{&contact, 1}, {&impulse, 1}, {velocity.data(), node_count}, {node.data(), node_count}, {}, {}, {}};
    RegionOutcome outcome{.iterations = 1, .shortcut = shortcut_closed_form};
    outcome.dissipated = write_back(stage, {&row, 1}, memory);
    if (!std::isfinite(size)) {
        outcome.status = RegionStatus::not_finite;
        outcome.error = size;
        return outcome;
    }
    Real push_impulse, push_bias;
    const PushMemory push{{&push_impulse, 1}, {&push_bias, 1}, {push_velocity.data(), node_count}};
    if (push_out_region({&contact, 1}, {&row, 1}, stage.inputs.gap, {velocity.data(), node_count}, stage.inputs.gravity, stage.settings,
                        stage.h, push))
        write_push(stage, memory.node, push.velocity);
    return outcome;
}

}  // namespace skerry
