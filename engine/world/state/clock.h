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
    // Duration of the forces in the last step [s]. It is 0 before the first step, and after an abandoned attempt, which
    // overwrites the relaxed strain of the last step in the elements. Only the measured dissipation depends on this
    // value.
    Real kick_before = 0;
    LongStepClock long_step;
};

}  // namespace skerry
