// Solver of regions of lumped contacts with the methods of the lab, otherwise like the stage solve_regions.
#pragma once

#include "jobs/executor.h"
#include "jobs/team.h"
#include "profiling/lab/methods.h"
#include "systems/solver/regions/region_memory.h"

namespace skerry::lab {

/// Reuses its memory from one call to the next.
class RegionSolver {
public:
    /// Solves regions one after the other like skerry::solve_regions, and ignores settings.method. Clusters, rigid
    /// bodies and implicit bodies are not supported.
    void solve(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Method method, Real h,
               RegionTable& regions, const RegionOutputs& out);

private:
    RegionMemory memory_;
    ColouredRegion coloured_;
    Team team_;  // for large regions
};

}  // namespace skerry::lab
