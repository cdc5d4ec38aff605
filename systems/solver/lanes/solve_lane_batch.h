// Up to eight small regions at once.
#pragma once

#include "systems/solver/lanes/lane_problem.h"

namespace skerry {

struct LaneResult {
    Index iterations = 0;
    Real error = 0;
    bool solved = false;
};

/// Solves at most element_lanes regions of one size class, each to its tolerance. Writes the impulses of those that are
/// solved; the others, which needed more sweeps than lanes do (lane_sweep_limit) or ran into a number that is not
/// finite, are left at their start. Nothing that is written of a region depends on the others of the batch.
void solve_lane_batch(std::size_t size_class, std::span<const LaneRegion> region, Index max_iterations, Real relaxation,
                      std::span<LaneResult> result);

}  // namespace skerry
