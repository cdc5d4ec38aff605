// Impulse and work of external forces in a step.
#pragma once

#include "components/types.h"

namespace skerry {

struct ExternalWork {
    Vec3 impulse = Vec3::Zero();  // [N s]
    Real work = 0;                // [J]
    Real flow = 0;                // sum of the magnitudes of all impulses [N s]
};

}  // namespace skerry
