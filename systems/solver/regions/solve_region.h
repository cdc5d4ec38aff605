// Solver of regions that one thread sweeps in the order of their contacts.
#pragma once

#include "systems/solver/regions/life_cycle.h"

namespace skerry {

using RegionInOrder = LoadedRegion<InOrder>;

/// Copies contacts and moving nodes side by side; `base` is the place of the first contact in the memory by contact.
/// Impulses are zero.
RegionInOrder load_region(const RegionStage& stage, std::span<const Index> row, Index base);

/// Runs the method of the settings from the present impulse.
RegionOutcome sweep_region(const RegionStage& stage, RegionInOrder& region);

/// Closed-form solution of a region with one contact: one contact step from zero.
RegionOutcome solve_single(const RegionStage& stage, Index row);

extern template bool start_region(const RegionStage&, const RegionInOrder&, RegionOutcome&);
extern template void finish_region(const RegionStage&, const RegionInOrder&, RegionOutcome&);

}  // namespace skerry
