// Regions that are worth all workers each: in their coloured order, by a team (docs/methods/region_solver.md 6).
#pragma once

#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// Whether the region is solved in its coloured order, however many workers there are: so its bits do not depend on
/// them. Not with fixed iterations, where a region alone and within a larger one are to go the same way, and not
/// through clusters.
bool is_large(const RegionStage& stage, const RegionTable& regions, Index number);

using RegionByColour = LoadedRegion<ByColour>;

/// As load_region, with the order and the nodes that order_region has found.
RegionByColour load_by_colour(const RegionStage& stage, std::span<const Index> row, Index base, Team& team,
                              ColouredRegion& kept);

/// Solves the large regions, one after the other.
void solve_large_regions(Executor& executor, const RegionStage& stage, RegionTable& regions);

}  // namespace skerry
