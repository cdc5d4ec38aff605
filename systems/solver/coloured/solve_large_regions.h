// Regions that are worth all workers each: loaded, solved, pushed out and written back by a team (methods.md 2.7, last but one row).
#pragma once

#include <memory>
#include <vector>

#include "systems/solver/coloured/order_region.h"

namespace skerry {

struct RegionStage;

/// Kept between steps.
struct LargeRegions {
    Team team;
    std::vector<std::unique_ptr<ColouredRegion>> region;  // the first large region of the step, the second, ...
};

/// Whether the region is solved in its coloured order, however many workers there are: so its bits do not depend on them. Not with fixed
/// iterations, where a region alone and within a larger one are to go the same way.
inline bool is_large(const SolverSettings& settings, std::size_t contacts) {
    return !settings.fixed_iterations && contacts >= static_cast<std::size_t>(settings.parallel_region_contacts);
}

/// Solves the large regions, one after the other.
void solve_large_regions(Executor& executor, const RegionStage& stage, RegionTable& regions);

}  // namespace skerry
