// Solver of large regions: a team of workers solves each region in its coloured order (docs/methods/region_solver.md
// 6).
#pragma once

#include "systems/solver/coloured/order_region.h"
#include "systems/solver/regions/lumped_region.h"

namespace skerry {

/// True if the region has enough contacts to be solved by a team of workers in its coloured order. Neither this answer
/// nor the results depend on the number of workers. It is false
/// - for regions that touch clusters or need BodyOperator (needs_blocks),
/// - with a fixed number of iterations: a group of contacts must then have the same iterates alone and in a larger
///   region.
bool is_large(const RegionStage& stage, const RegionTable& regions, Index number);

using RegionByColour = LumpedRegion<ByColour>;

/// Version of load_region that uses the order and the nodes from order_region.
RegionByColour load_by_colour(const RegionStage& stage, std::span<const Index> row, Index base, Team& team,
                              ColouredRegion& kept);

/// Solves the large regions, one after the other.
void solve_large_regions(Executor& executor, const RegionStage& stage, RegionTable& regions);

}  // namespace skerry
