// The times of a world.
#pragma once

#include "components/types.h"

namespace skerry {

/// A long step: the time that implicit bodies cover with one step of their deformation, while all other bodies take
/// several steps. No long step outlasts a call of advance().
struct LongStepClock {
    Real length = 0;     // length of the long step; 0: there is no long step [s]
    Real remaining = 0;  // time until the end of the long step [s]
};

/// Times of a world. All members are part of its state, since the next step depends on them.
struct Clock {
    Real time = 0;  // start of the next step [s]
    // time by which positions are ahead of velocities; nonzero only with leapfrog, within advance() [s]
    Real offset = 0;
    // Length of the last step [s]; 0 before the first step. With symplectic Euler, velocities are half of this step
    // behind positions.
    Real step_before = 0;
    LongStepClock long_step;
};

}  // namespace skerry
