// What happens to every region of a step, whatever its size and in whichever order its contacts are passed over: load,
// start, sweep (by a method, in lanes or on normal rows), write back, push out. Walk: InOrder or ByColour.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "components/region_table.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/load_contact.h"
#include "systems/solver/local/load_sums.h"
#include "systems/solver/local/push_contact.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/regions/region_memory.h"

namespace skerry {

/// What all regions of a step share.
struct RegionStage {
    const RegionInputs& inputs;
    const SolverSettings& settings;
    Real h;  // s
    const RegionOutputs& out;
    RegionMemory& memory;
};

struct RegionOutcome {
    Index iterations = 0;
    Real error = 0;
    RegionStatus status = RegionStatus::converged;
    RegionShortcut shortcut = shortcut_none;
    Real dissipated = 0;  // J
    Real push_work = 0;   // J
};

/// Of what a method came to: whoever ends within settings.tolerance has converged.
RegionOutcome outcome_of(const SolveResult& result, const SolverSettings& settings);
/// Puts an outcome into the region's row.
void write_outcome(const RegionOutcome& outcome, Index number, RegionTable& regions);

SolveLimits limits_of(const SolverSettings& settings, Real tolerance);

/// What a region with these contacts is solved to: closer where all that it touches is still, so that what the solver
/// leaves does not keep it from rest (docs/methods/errors.md 7).
Real tolerance_of(const RegionStage& stage, std::span<const Index> row);

/// One region, with its part of the memory in the order of the walk.
template <RegionWalk Walk>
struct LoadedRegion {
    std::span<const Index> row;  // of its contacts, by number in the region
    Index base = 0;              // place of the first in the memory by contact
    Walk walk{};
    LumpedMemory memory{};
    LoadSums sums{};
    Real scale = 0;      // sqrt(J), of e_nat
    Real tolerance = 0;  // of this region

    Index row_at(std::size_t place) const { return row[walk.number_of(place)]; }
};

/// The memory of `count` contacts from `base` on, and of their nodes: `node` are rows of NodeTable.
LumpedMemory memory_from(const RegionStage& stage, Index base, std::size_t count, std::span<const Index> node);
/// The same where nodes are not kept four by contact: `first_node` is the place of the first.
LumpedMemory memory_from(const RegionStage& stage, Index base, std::size_t count, std::span<const Index> node,
                         std::size_t first_node);
/// `velocity`: by node of the region, for the result.
PushMemory push_memory(const RegionStage& stage, Index base, std::size_t count, std::span<Vec4> velocity);

/// J, taken out by a contact whose impulse and velocities are written (docs/methods/time_stepping.md 2.6).
Real dissipated_by(const RegionStage& stage, Index row);

/// Load: writes the contacts in the order of the walk, and zero impulses. `numbering(k)` gives what turns a moving node
/// of the region's contact k into the region's own row; velocities must be there when it has.
template <RegionWalk Walk, class Numbering>
void load_contacts(const RegionStage& stage, LoadedRegion<Walk>& region, Numbering&& numbering) {
    RegionMemory& data = stage.memory;
    const std::size_t first = static_cast<std::size_t>(region.base);
    const bool keep_free_velocity = Walk::one_thread && workspace_slots(stage.settings.method) > 1;  // for lanes
    const Vec4* velocity = region.memory.velocity.data();
    region.sums = region.walk.template sum<LoadSums>(region.row.size(), [&](std::size_t begin, std::size_t end) {
        LoadSums sums;
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t number = region.walk.number_of(i);
            LumpedContact& contact = data.contact[first + i];
            contact = load_contact(stage.inputs, region.row[number], stage.out.velocity_next, stage.settings, stage.h,
                                   numbering(number));
            if constexpr (!Walk::own_masses) {
                if (contact.node_count > 0) {
                    contact.diagonal = region.walk.coupling(contact, contact);
                    contact.inverse_diagonal = 1 / contact.diagonal;
                }
            }
            const Vec4 u = contact_velocity(contact, velocity);
            sums.add(contact, stage.settings.friction, u);
            data.impulse[first + i].setZero();
            if (keep_free_velocity) data.workspace[free_velocity_slot][first + i] = u;
        }
        return sums;
    });
    region.tolerance = tolerance_of(stage, region.row);
    region.scale = error_scale(region.sums, stage.inputs.gravity, stage.h, region.tolerance);
}

template <RegionWalk Walk>
LumpedOperatorBy<Walk> operator_of(const RegionStage& stage, const LoadedRegion<Walk>& region) {
    return {region.memory, stage.settings.friction, region.scale, region.walk};
}

/// The impulses of the last step, and the velocities that they make. Rows without friction move along the normal alone.
template <RegionWalk Walk>
void take_warm_start(const RegionStage& stage, const LoadedRegion<Walk>& region) {
    const LumpedMemory& memory = region.memory;
    region.walk.contacts(region.row.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const LumpedContact& contact = memory.contact[i];
            if (contact.node_count == 0) continue;
            const Vec4 last = padded(stage.out.impulse[region.row_at(i)]);
            memory.impulse[i] = contact.friction.stick == 0 ? Vec4(contact.normal.dot(last) * contact.normal) : last;
            region.walk.apply(contact, memory.impulse[i], memory.velocity.data());
        }
    });
}

/// A warm start within the tolerance needs no sweep: true, with the outcome. One that is so far off that zero is nearer
/// gives way to zero.
template <ContactOperator Op>
bool start_from_warm_impulse(Op& op, const SolverSettings& settings, Real tolerance, RegionOutcome& outcome) {
    const Real error = op.error();
    if (error <= tolerance && settings.certify_warm_start) {
        outcome = {.error = error, .status = RegionStatus::certified, .shortcut = shortcut_certified};
        return true;
    }
    if (error <= suspicious_start) return false;
    // workspace 0 keeps the warm start while zero is looked at
    BestIterate<Op> better(op);
    better.offer(error);
    std::ranges::fill(op.impulse(), Vec4::Zero());
    op.refresh();
    if (error < op.error()) better.restore();
    return false;
}

/// Start: takes the warm start unless zero is nearer. Returns true, with the outcome, when nothing is left to do.
template <RegionWalk Walk>
bool start_region(const RegionStage& stage, const LoadedRegion<Walk>& region, RegionOutcome& outcome) {
    const SolverSettings& settings = stage.settings;
    if (settings.fixed_iterations) {
        // Where nothing moves zero is the solution, and what sweeps leave of another start has no scale to be compared
        // with. What only separates starts from its impulses, too: what a sweep does must not depend on how regions are
        // cut.
        if (settings.warm_start == WarmStart::on && region.scale > 0) take_warm_start(stage, region);
        return false;
    }
    if (region.sums.separating && settings.skip_separating) {
        outcome = {.status = RegionStatus::certified, .shortcut = shortcut_separating};
        return true;
    }
    if (settings.warm_start == WarmStart::off) return false;
    take_warm_start(stage, region);
    LumpedOperatorBy<Walk> op = operator_of(stage, region);
    return start_from_warm_impulse(op, settings, region.tolerance, outcome);
}

/// Write back: velocities and impulses. Returns what the region dissipated, J. Inlined by order, as is finish_region:
/// most regions are of one contact, for which the loops dissolve.
template <RegionWalk Walk>
[[gnu::always_inline]] inline Real write_back(const RegionStage& stage, const LoadedRegion<Walk>& region) {
    const LumpedMemory& memory = region.memory;
    region.walk.nodes(memory.node.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            stage.out.velocity_next[memory.node[n]] = memory.velocity[n].template head<3>();
    });
    return region.walk.template sum<Real>(region.row.size(), [&](std::size_t begin, std::size_t end) {
        Real dissipated = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const Index row = region.row_at(i);
            stage.out.impulse[row] = memory.impulse[i].template head<3>();
            dissipated += dissipated_by(stage, row);
        }
        return dissipated;
    });
}

/// What a push is solved on: contacts by place in the walk, `row` by number in the region, solved velocities by node.
struct PushedRegion {
    std::span<const Index> row;
    std::span<const LumpedContact> contact;
    std::span<const Vec4> velocity;
    Real tolerance;
};

/// Frictionless pseudo velocities p with u_n + p_n >= min(recovery |gap| / h, recovery_speed) where the gap is below
/// the slop, and elsewhere no approach that the velocity solve would not allow. Returns false, and writes nothing, when
/// no contact is pressed in.
template <RegionWalk Walk>
bool solve_push(const RegionStage& stage, Walk walk, const PushedRegion& region, const PushMemory& memory) {
    const SolverSettings& settings = stage.settings;
    const std::span<const LumpedContact> contact = region.contact;
    const std::span<const Real> gap = stage.inputs.gap;
    const Real slop = push_slop(stage.inputs.gravity, stage.h);
    if (std::none_of(region.row.begin(), region.row.end(), [&](Index i) { return gap[i] < -slop; })) return false;
    walk.nodes(memory.velocity.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) memory.velocity[n].setZero();
    });
    // J, of the push asked for
    const Real asked = walk.template sum<Real>(contact.size(), [&](std::size_t begin, std::size_t end) {
        Real size = 0;
        for (std::size_t i = begin; i < end; ++i) {
            memory.impulse[i] = 0;
            const Real along =
                contact[i].normal.dot(contact_velocity(contact[i], region.velocity.data())) - contact[i].bias;
            memory.bias[i] =
                push_bias(along, gap[region.row[walk.number_of(i)]], slop, settings, stage.inputs.gravity, stage.h);
            const Real approach = std::min(memory.bias[i], Real(0));
            size += contact[i].inverse_diagonal * approach * approach;
        }
        return size;
    });
    const Real small = region.tolerance * region.tolerance * asked;
    for (Index iteration = 1; iteration <= settings.max_iterations; ++iteration) {
        const Real change = walk.template sum<Real>(contact.size(), [&](std::size_t begin, std::size_t end) {
            Real size = 0;
            for (std::size_t i = begin; i < end; ++i)
                size += push_contact(contact[i], memory.bias[i], memory.velocity.data(), memory.impulse[i],
                                     [&walk](const LumpedContact& of, const Vec4& impulse, Vec4* velocity) {
                                         walk.apply(of, impulse, velocity);
                                     });
            return size;
        });
        if (change <= small && !settings.fixed_iterations) break;
    }
    return true;
}

/// J, that moving positions by h p takes against the forces of the step but for those of contacts: h times the force on
/// a node is its momentum after the step, less that before and less what its contacts gave. To first order in h p.
Real push_work(const RegionStage& stage, const LumpedMemory& memory, std::span<const Vec4> push_velocity);
/// The same where nodes of clusters are not moved by their own masses: what forces gave them is known. Rows of
/// velocities before `first_node` are of no node.
Real push_work_through_clusters(const RegionStage& stage, const LumpedMemory& memory,
                                std::span<const Vec4> push_velocity, std::size_t first_node = 0);

/// Finish: writes back, pushes out, and notes what was dissipated.
template <RegionWalk Walk>
[[gnu::always_inline]] inline void finish_region(const RegionStage& stage, const LoadedRegion<Walk>& region,
                                                 const PushMemory& push, RegionOutcome& outcome) {
    outcome.dissipated = write_back(stage, region);
    if (outcome.status == RegionStatus::not_finite) return;
    const PushedRegion pushed{region.row, region.memory.contact, region.memory.velocity, region.tolerance};
    if (!solve_push(stage, region.walk, pushed, push)) return;
    region.walk.nodes(push.velocity.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            stage.out.push_out[region.memory.node[n]] = push.velocity[n].template head<3>();
    });
    if constexpr (Walk::own_masses)
        outcome.push_work = push_work(stage, region.memory, push.velocity);
    else
        outcome.push_work = push_work_through_clusters(stage, region.memory, push.velocity);
    stage.memory.pushed.store(true, std::memory_order_relaxed);
}
template <RegionWalk Walk>
void finish_region(const RegionStage& stage, const LoadedRegion<Walk>& region, RegionOutcome& outcome) {
    finish_region(stage, region, push_memory(stage, region.base, region.row.size(), region.memory.scratch), outcome);
}

}  // namespace skerry
