// One region of the step: load, solve, write back.
#pragma once

#include <span>

#include "components/region_table.h"
#include "systems/solver/solver_memory.h"

namespace skerry {

/// What all regions of a step share.
struct RegionStage {
    const RegionInputs& inputs;
    const SolverSettings& settings;
    Real h;  // s
    const RegionOutputs& out;
    SolverMemory::Data& memory;
};

struct RegionOutcome {
    Index iterations = 0;
    Real error = 0;
    RegionStatus status = RegionStatus::converged;
    Real dissipated = 0;  // J
};

/// Contacts `row`; `base` is the place of the first in the memory by contact.
RegionOutcome solve_region(const RegionStage& stage, std::span<const Index> row, Index base);

/// Closed form of a region of one contact: one contact step from zero.
RegionOutcome solve_single(const RegionStage& stage, Index row);

}  // namespace skerry
