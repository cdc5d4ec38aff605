// Solver of up to eight small regions at once, in SIMD lanes.
#pragma once

#include "systems/solver/lanes/lane_problem.h"

namespace skerry {

struct LaneResult {
    Index iterations = 0;
    Real error = 0;
    bool solved = false;
};

/// Solves at most element_lanes regions of one size class, each to its tolerance, and writes the impulses of solved
/// regions. `size_class`: index in lane_sizes.
///
/// A region remains unsolved, with unchanged start impulses, if it needs more than lane_sweep_limit sweeps or if a
/// value is not finite. Its output does not depend on the other regions of the batch.
void solve_lane_batch(std::size_t size_class, std::span<const LaneRegion> region, Index max_iterations, Real relaxation,
                      std::span<LaneResult> result);

}  // namespace skerry
