// The times of a world.
#pragma once

#include "components/types.h"

namespace skerry {

/// A long step of the implicit bodies, in which all others take several steps. None is open between calls of advance().
struct LongStepClock {
    Real length = 0;  // length of the long step; 0: there is none [s]
    Real left = 0;    // time to its end [s]
};

/// All members are state: the next step depends on them.
struct Clock {
    Real time = 0;    // start of the next step [s]
    Real offset = 0;  // lead of positions over velocities; nonzero only with leapfrog, within advance() [s]
    // length of the last step; velocities are half of it behind positions (symplectic Euler); 0: no step yet [s]
    Real step_before = 0;
    // Interval over which forces acted in the last step, while elements still know its relaxed strain; else 0 [s]. Only
    // the booked dissipation depends on it.
    Real kick_before = 0;
    LongStepClock long_step;
};

}  // namespace skerry
