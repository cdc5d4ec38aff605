// Solves all regions of the step, concurrently (docs/methods/region_solver.md 8, docs/methods/regions.md 4).
#pragma once

#include <memory>

#include "components/region_table.h"
#include "jobs/executor.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"

namespace skerry {

struct RegionMemory;

/// Working memory of the stage, kept between steps. It allocates only if a step is larger than all before.
class SolverMemory {
public:
    SolverMemory();
    ~SolverMemory();
    RegionMemory& data() { return *data_; }

private:
    std::unique_ptr<RegionMemory> data_;
};

/// Solves every region to the tolerance: in closed form for a single contact, otherwise by the method of the settings.
/// Regions run as concurrent jobs, largest first, small ones in batches; no two regions write the same node. Fills the
/// outcome columns of `regions` (iterations, error, status and others) and regions.pushed. Returns false if there are
/// no regions (skipped).
bool solve_regions(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Real h,
                   SolverMemory& memory, RegionTable& regions, const RegionOutputs& out);

}  // namespace skerry
