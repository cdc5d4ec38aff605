// PhaseRunner: an interface of executors that run every block themselves, including those of a Team.
#pragma once

#include <span>

#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// Additional base class of an executor that runs the phases of a Team itself. Profiling uses it to record the blocks
/// one by one. A Team gathered on such an executor calls no other worker.
class PhaseRunner {
public:
    virtual ~PhaseRunner() = default;

    /// Runs the phases under the same contract as Team::run_phases.
    virtual void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body) = 0;
};

}  // namespace skerry
