// Motion of all nodes in an attempt at a step.
#pragma once

#include <span>

#include "components/types.h"

namespace skerry {

struct StepMotion {
    // by node: velocity at the end of the step, and velocity of the push-out, which acts in this step only [m/s]
    std::span<const Vec3> velocity_next, push_out;
    Real h;  // length of the step [s]

    Vec3 displacement(Index node) const { return h * (velocity_next[node] + push_out[node]); }
};

}  // namespace skerry
