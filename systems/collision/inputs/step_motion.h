// Motion of all nodes in an attempt at a step.
#pragma once

#include <span>

#include "components/types.h"

namespace skerry {

struct StepMotion {
    std::span<const Vec3> velocity_next, push_out;  // by node [m/s]
    Real h;                                         // length of the step [s]

    Vec3 of(Index node) const { return h * (velocity_next[node] + push_out[node]); }
};

}  // namespace skerry
