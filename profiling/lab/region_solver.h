// Regions of lumped contacts, solved by the methods of the lab as the stage solve_regions solves them by its own.
#pragma once

#include "jobs/executor.h"
#include "jobs/team.h"
#include "profiling/lab/methods.h"
#include "systems/solver/regions/region_memory.h"

namespace skerry::lab {

/// Keeps its memory from one call to the next.
class RegionSolver {
public:
    /// Solves regions like skerry::solve_regions, one after the other, and ignores settings.method. Without clusters,
    /// rigid and implicit bodies.
    void solve(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Method method, Real h,
               RegionTable& regions, const RegionOutputs& out);

private:
    RegionMemory memory_;
    ColouredRegion coloured_;
    Team team_;  // of large regions
};

}  // namespace skerry::lab
