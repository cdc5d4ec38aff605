// Where a world stands in time.
#pragma once

#include <array>
#include <cstdint>

#include "components/step_levels.h"
#include "components/types.h"

namespace skerry {

/// Where the world stands between two moments at which all levels have had their impulses (step/plan_step.cpp).
struct StepCycle {
    int levels = 0;  // the cycle has 2^levels steps
    int index = 0;   // steps taken of it
    Real h = 0;      // s, of its steps, if none had to be shortened
    // s, by which the impulses of a level are ahead of time; between cycles zero
    std::array<Real, step_level_count> lead{};
    std::array<std::uint64_t, step_level_count> elements{};  // of each level in this cycle
};

/// A step of implicit bodies in which the others take several. None between calls of advance.
struct LongStepClock {
    Real length = 0;  // s; 0: there is none
    Real left = 0;    // s, to its end
};

/// All of it is state: the next step depends on it.
struct Clock {
    Real time = 0;    // s, start of the next step
    Real offset = 0;  // s, by which positions are ahead of velocities; only leapfrog, and only within advance
    // s, of the last step: velocities are half of it behind positions (symplectic Euler); 0: no step yet
    Real step_before = 0;
    // s, for which forces acted in it, while elements know what relaxed in it; else 0. Only what is booked as lost
    // depends on it.
    Real kick_before = 0;
    StepCycle cycle;
    LongStepClock long_step;
};

}  // namespace skerry
