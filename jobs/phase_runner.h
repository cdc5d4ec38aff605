// PhaseRunner: interface of an executor that also runs the phases of a Team.
#pragma once

#include <span>

#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// Additional base class of an executor that runs the phases of a Team itself. Profiling uses such an executor to
/// record the blocks one by one. If Team::gather() gets such an executor, the Team uses no workers of its own.
class PhaseRunner {
public:
    virtual ~PhaseRunner() = default;

    /// Runs the phases. The contract is that of Team::run_phases.
    virtual void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body) = 0;
};

}  // namespace skerry
