// Solver of all regions of a step, which run concurrently (docs/methods/region_solver.md 8, docs/methods/regions.md 4).
#pragma once

#include <memory>

#include "components/region_table.h"
#include "jobs/executor.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"

namespace skerry {

struct RegionMemory;

/// Working memory of solve_regions, reused from step to step. It allocates only if a step has more contacts or nodes
/// than all earlier steps.
class SolverMemory {
public:
    SolverMemory();
    ~SolverMemory();
    RegionMemory& data() { return *data_; }
    /// Must be called if NodeTable::push_out was written outside of solve_regions. The next call of solve_regions then
    /// clears this column.
    void note_push();

private:
    std::unique_ptr<RegionMemory> data_;
};

/// Solves every region to its tolerance: a single contact in closed form, other regions by the method of the settings.
/// Fills regions.pushed and the outcome columns of `regions` (iterations, error, status and others). Returns false if
/// there are no regions.
///
/// First a team of workers solves each large region. Then tasks solve the other regions concurrently, the most
/// expensive ones first, small ones in batches. No two regions write the same node.
bool solve_regions(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Real h,
                   SolverMemory& memory, RegionTable& regions, const RegionOutputs& out);

}  // namespace skerry
