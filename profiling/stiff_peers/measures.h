// Measures of a run of one of the scenes by any engine, from the positions and velocities of nodes alone.
#pragma once

#include <limits>

#include "profiling/work_precision/record.h"

namespace skerry::profiling {

/// Measures of a run. A measure without meaning in a scene is NaN.
struct Measures {
    static constexpr Real none = std::numeric_limits<Real>::quiet_NaN();
    Real creep = none;                   // speed of the centre of mass over the second half [m/s]
    Real acceleration_error = none;      // over the second half, relative to the acceleration by Coulomb's law
    Real period = none;                  // of the cantilever's end [s]
    Real peak = none, peak_time = none;  // first peak of the cantilever, or deepest position of the ball [m], [s]
    Real left = none;                    // peak-to-peak amplitude of the fifth period over the first peak
    Real speed = none;                   // root mean square over nodes in the last 0.1 s [m/s]
    Real overlap = none, overlap_at_end = none;  // depth of nodes in other bodies [m]
    Real below_planes = none;                    // depth of nodes in floor and walls [m]
};

Measures measure(const PrecisionScene& scene, const Record& record);

}  // namespace skerry::profiling
