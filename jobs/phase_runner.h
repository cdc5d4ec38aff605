// PhaseRunner: an interface of executors that run every block themselves, including those of a Team.
#pragma once

#include <span>

#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// Additional base class of an executor that runs the phases of a Team itself; profiling uses it to record their blocks
/// one by one. A Team gathered on it calls no other worker.
class PhaseRunner {
public:
    virtual ~PhaseRunner() = default;

    /// Same contract as Team::run_phases.
    virtual void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body) = 0;
};

}  // namespace skerry
