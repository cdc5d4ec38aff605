// The times of a world.
#pragma once

#include "components/types.h"

namespace skerry {

/// A long step of the implicit bodies, during which all other bodies take several steps. Between calls of advance()
/// there is no long step.
struct LongStepClock {
    Real length = 0;  // length of the long step; 0: there is no long step [s]
    Real left = 0;    // time to the end of the long step [s]
};

/// Times of a world. All members are part of its state, since the next step depends on them.
struct Clock {
    Real time = 0;    // start of the next step [s]
    Real offset = 0;  // lead of positions over velocities; nonzero only with leapfrog, within advance() [s]
    // Length of the last step; 0: no step yet [s]. With symplectic Euler, velocities are half a step behind positions.
    Real step_before = 0;
    // Time for which forces acted in the last step [s]. It is 0 if the elements no longer store the relaxed strain of
    // that step. Only the measured dissipation depends on it.
    Real kick_before = 0;
    LongStepClock long_step;
};

}  // namespace skerry
