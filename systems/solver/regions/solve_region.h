// Solvers of regions of lumped masses. One thread solves a region in the order of its contacts.
#pragma once

#include "systems/solver/operators/in_order.h"
#include "systems/solver/regions/lumped_region.h"

namespace skerry {

using RegionInOrder = LumpedRegion<InOrder>;

/// Copies the contacts and moving nodes of a region to contiguous memory. `base` is the index of its first contact in
/// the columns by contact of RegionMemory. Impulses are zero.
RegionInOrder load_region(const RegionStage& stage, std::span<const Index> row, Index base);

/// Runs the method of the settings from the present impulses. For a frictionless region, if the settings allow it, the
/// sweeps change only the normal impulses (NormalRows).
RegionOutcome sweep_in_order(const RegionStage& stage, const RegionInOrder& region, LumpedOperator& op);

/// Solves a region with one contact in closed form: one contact step from zero impulse.
RegionOutcome solve_single(const RegionStage& stage, Index row, Index base);

/// Solves a region whose contacts touch clusters of nodes but no rigid body (docs/methods/clusters.md 4).
RegionOutcome solve_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base);

extern template bool start_region(const RegionStage&, const RegionInOrder&, LumpedOperator&, RegionOutcome&);

}  // namespace skerry
