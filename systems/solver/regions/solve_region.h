// Solvers of regions of lumped masses, each by one thread in the order of the contacts.
#pragma once

#include "systems/solver/operators/in_order.h"
#include "systems/solver/regions/lumped_region.h"

namespace skerry {

using RegionInOrder = LumpedRegion<InOrder>;

/// Copies contacts and moving nodes side by side; `base` is the place of the first contact in the memory by contact.
/// Impulses are zero.
RegionInOrder load_region(const RegionStage& stage, std::span<const Index> row, Index base);

/// Runs the method of the settings from the present impulse, on normal rows if the region has no friction.
RegionOutcome sweep_in_order(const RegionStage& stage, const RegionInOrder& region, LumpedOperator& op);

/// Closed-form solution of a region with one contact: one contact step from zero.
RegionOutcome solve_single(const RegionStage& stage, Index row, Index base);

/// Solves a region whose contacts touch clusters of nodes but no rigid body (docs/methods/clusters.md 4).
RegionOutcome solve_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base);

extern template bool start_region(const RegionStage&, const RegionInOrder&, LumpedOperator&, RegionOutcome&);

}  // namespace skerry
