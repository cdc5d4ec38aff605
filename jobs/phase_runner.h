// PhaseRunner: an executor that wants to see every block, those of a Team included.
#pragma once

#include <span>

#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// What an executor is, too, that runs the phases of a Team itself: profiling records their blocks one by one. A Team
/// gathered on it calls no other worker.
class PhaseRunner {
public:
    virtual ~PhaseRunner() = default;

    /// As Team::run_phases.
    virtual void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body) = 0;
};

}  // namespace skerry
