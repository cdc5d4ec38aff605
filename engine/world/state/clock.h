// Where a world stands in time.
#pragma once

#include "components/types.h"

namespace skerry {

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
    LongStepClock long_step;
};

}  // namespace skerry
