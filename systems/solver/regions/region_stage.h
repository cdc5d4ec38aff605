// Data that all regions of a step share, the outcome of a region, and access to the regions' memory.
#pragma once

#include <span>

#include "components/region_table.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/push_contact.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/regions/region_memory.h"

namespace skerry {

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

/// Converts the result of a method. An error within settings.tolerance counts as converged, even if the tolerance of
/// the region is smaller.
RegionOutcome outcome_of(const SolveResult& result, const SolverSettings& settings);
/// Writes an outcome to the region's row of RegionTable.
void write_outcome(const RegionOutcome& outcome, Index number, RegionTable& regions);

SolveLimits limits_of(const SolverSettings& settings, Real tolerance);

/// Tolerance of a region with the contacts `row`: SolverSettings::tolerance, or the smaller still_tolerance if all
/// bodies of these contacts are still. With a greater tolerance, solver errors would give such bodies velocities that
/// keep them awake (docs/methods/errors.md 7).
Real tolerance_of(const RegionStage& stage, std::span<const Index> row);

/// Memory of one region: `count` entries of the columns by contact from index `base` on, and node.size() entries of the
/// columns by node from index `first_node` on. `node` lists the rows of NodeTable. `slots`: number of workspace
/// vectors.
ContactMemory memory_from(const RegionStage& stage, Index base, std::size_t count, std::size_t first_node,
                          std::span<const Index> node, std::size_t slots);
/// Velocity that a node would have after the step without contact impulses [m/s]
inline Vec4 free_velocity_of(const RegionStage& stage, Index node) {
    return padded(stage.out.velocity_next[node]);
}
/// Memory of the split impulse for `count` contacts from row `base` on.
PushMemory push_memory(const RegionStage& stage, Index base, std::size_t count);

/// Energy that a contact dissipates (docs/methods/time_stepping.md 2.6). `stage.out` must already contain the impulse
/// of the contact and the velocities of its nodes [J].
Real dissipated_by(const RegionStage& stage, Index row);

/// Work against the forces of the step, without contact forces, when nodes are displaced by h p, with the pseudo
/// velocities p in memory.scratch [J]. It is accurate to first order in h p. `own_masses`: true if the region has
/// neither clusters nor rigid bodies.
///
/// The force on a node, times h, is its change of momentum minus its contact impulses. For a node of a cluster it is
/// read from RegionInputs::cluster_kick, because the momentum involves the coupled masses of the whole cluster.
Real push_work_of_nodes(const RegionStage& stage, const ContactMemory& memory, bool own_masses);

}  // namespace skerry
