// Solves all regions of the step, concurrently (docs/methods/region_solver.md 8, docs/methods/regions.md 4).
#pragma once

#include <memory>

#include "components/region_table.h"
#include "jobs/executor.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"

namespace skerry {

struct RegionMemory;

/// Working memory of the stage, kept between steps so that it allocates only when the step is larger than any before.
class SolverMemory {
public:
    SolverMemory();
    ~SolverMemory();
    RegionMemory& data() { return *data_; }

private:
    std::unique_ptr<RegionMemory> data_;
};

/// Solves every region to the tolerance: closed form for a single contact, else the method of the settings. Regions run
/// as concurrent jobs, largest first, small ones batched; no two write the same node. Fills iterations, error and
/// status of the regions, and whether they pushed. Returns false when there are no regions (skipped).
bool solve_regions(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Real h,
                   SolverMemory& memory, RegionTable& regions, const RegionOutputs& out);

}  // namespace skerry
