// The steps that every region goes through, for any size and order of contacts: load, start, sweep (by a method, in
// lanes or on normal rows), write back, push out. Walk: InOrder, ByColour or ThroughClusters.
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

/// Data that all regions of a step share.
struct RegionStage {
    const RegionInputs& inputs;
    const SolverSettings& settings;
    Real h;  // length of the step [s]
    const RegionOutputs& out;
    RegionMemory& memory;
};

struct RegionOutcome {
    Index iterations = 0;
    Real error = 0;
    RegionStatus status = RegionStatus::converged;
    RegionShortcut shortcut = shortcut_none;
    Real dissipated = 0;  // [J]
    Real push_work = 0;   // [J]
};

/// Converts the result of a method: an error within settings.tolerance counts as converged.
RegionOutcome outcome_of(const SolveResult& result, const SolverSettings& settings);
/// Writes an outcome to the region's row.
void write_outcome(const RegionOutcome& outcome, Index number, RegionTable& regions);

SolveLimits limits_of(const SolverSettings& settings, Real tolerance);

/// Tolerance of a region with these contacts. It is smaller if all touched bodies are still; otherwise the remaining
/// solver error would keep them from coming to rest (docs/methods/errors.md 7).
Real tolerance_of(const RegionStage& stage, std::span<const Index> row);

/// One region and its part of the memory, in the order of the walk.
template <RegionWalk Walk>
struct LoadedRegion {
    std::span<const Index> row;  // rows of ContactTable, by number of the contact in the region
    Index base = 0;              // place of its first contact in the columns by contact
    Walk walk{};
    LumpedMemory memory{};
    LoadSums sums{};
    Real scale = 0;      // scale of e_nat [sqrt(J)]
    Real tolerance = 0;  // tolerance of this region

    Index row_at(std::size_t place) const { return row[walk.number_of(place)]; }
};

/// Memory of `count` contacts starting at `base`, and of their nodes. `node` holds rows of NodeTable.
LumpedMemory memory_from(const RegionStage& stage, Index base, std::size_t count, std::span<const Index> node);
/// Overload for regions that do not reserve four nodes per contact. `first_node` is the place of the first node.
LumpedMemory memory_from(const RegionStage& stage, Index base, std::size_t count, std::span<const Index> node,
                         std::size_t first_node);
/// Memory of the split impulse. `velocity` receives the result, by node of the region.
PushMemory push_memory(const RegionStage& stage, Index base, std::size_t count, std::span<Vec4> velocity);

/// Energy that a contact dissipates; its impulse and velocities must be written already (docs/methods/time_stepping.md
/// 2.6) [J]
Real dissipated_by(const RegionStage& stage, Index row);

/// Load: writes the contacts in the order of the walk, and zero impulses. `numbering(k)` returns a function from a
/// moving node of the region's contact k to the region's own row. The velocity of that row must be set by then.
template <RegionWalk Walk, class Numbering>
void load_contacts(const RegionStage& stage, LoadedRegion<Walk>& region, Numbering&& numbering) {
    RegionMemory& data = stage.memory;
    const std::size_t first = static_cast<std::size_t>(region.base);
    const bool keep_free_velocity = Walk::one_thread && workspace_slots(stage.settings.method) > 1;  // lanes need it
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

/// Takes the impulses of the last step and applies them to the velocities. Frictionless contacts keep the normal part.
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

/// Evaluates the warm start. Returns true, with the outcome, if its error is within the tolerance: no sweep is needed.
/// If its error is large and zero impulses have a smaller one, starts from zero.
template <ContactOperator Op>
bool start_from_warm_impulse(Op& op, const SolverSettings& settings, Real tolerance, RegionOutcome& outcome) {
    const Real error = op.error();
    if (error <= tolerance && settings.certify_warm_start) {
        outcome = {.error = error, .status = RegionStatus::certified, .shortcut = shortcut_certified};
        return true;
    }
    if (error <= suspicious_start) return false;
    // workspace 0 keeps the warm start while zero impulses are evaluated
    BestIterate<Op> better(op);
    better.offer(error);
    std::ranges::fill(op.impulse(), Vec4::Zero());
    op.refresh();
    if (error < op.error()) better.restore();
    return false;
}

/// Start: takes the warm start, or zero impulses if those are clearly better. Returns true, with the outcome, if the
/// region is solved.
template <RegionWalk Walk>
bool start_region(const RegionStage& stage, const LoadedRegion<Walk>& region, RegionOutcome& outcome) {
    const SolverSettings& settings = stage.settings;
    if (settings.fixed_iterations) {
        // If nothing moves, zero is the solution and no scale exists to judge the remainder of another start.
        // Separating regions also start from their impulses: a sweep must not depend on how contacts are split into
        // regions.
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

/// Write back: stores velocities and impulses. Returns the energy that the region dissipated [J]. This function and
/// finish_region are always inlined: most regions have one contact, and the compiler then removes the loops.
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

/// Data for the split impulse: contacts by place in the walk, `row` by number in the region, solved velocities by node.
struct PushedRegion {
    std::span<const Index> row;
    std::span<const LumpedContact> contact;
    std::span<const Vec4> velocity;
    Real tolerance;
};

/// Finds frictionless pseudo velocities p with u_n + p_n >= min(recovery |gap| / h, recovery_speed), further limited by
/// push_speed, where the gap is below the slop. Elsewhere they allow no approach that the velocity solve would not
/// allow. Returns false and writes nothing if no contact is pressed in.
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
    // scale of the requested push [J]
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

/// Work of moving positions by h p against the forces of the step without contacts. h times the force on a node is its
/// change of momentum minus the impulses of its contacts. First order in h p [J]
Real push_work(const RegionStage& stage, const LumpedMemory& memory, std::span<const Vec4> push_velocity);
/// Variant for nodes whose mass is coupled in clusters: it uses their known force impulses. Rows of velocities before
/// `first_node` belong to no node.
Real push_work_through_clusters(const RegionStage& stage, const LumpedMemory& memory,
                                std::span<const Vec4> push_velocity, std::size_t first_node = 0);

/// Finish: writes back, pushes out, and records the dissipated energy.
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
