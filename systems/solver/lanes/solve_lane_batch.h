// Solver of up to eight small regions at once.
#pragma once

#include "systems/solver/lanes/lane_problem.h"

namespace skerry {

struct LaneResult {
    Index iterations = 0;
    Real error = 0;
    bool solved = false;
};

/// Solves at most element_lanes regions of one size class, each to its tolerance. Writes the impulses of solved
/// regions. The others keep their start: they need more sweeps than lane_sweep_limit, or a number is not finite. The
/// output of a region does not depend on the other regions of the batch.
void solve_lane_batch(std::size_t size_class, std::span<const LaneRegion> region, Index max_iterations, Real relaxation,
                      std::span<LaneResult> result);

}  // namespace skerry
