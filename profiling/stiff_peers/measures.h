// What a run of one of the scenes is measured by, whoever ran it: from the places and velocities of nodes alone.
#pragma once

#include <limits>

#include "profiling/work_precision/record.h"

namespace skerry::profiling {

/// What has no meaning in a scene is not a number.
struct Measures {
    static constexpr Real none = std::numeric_limits<Real>::quiet_NaN();
    Real creep = none;                           // m/s, of the centre of mass over the second half
    Real acceleration_error = none;              // over the second half, part of the law's
    Real period = none;                          // s, of the cantilever's end
    Real peak = none, peak_time = none;          // m, s: its first one, or the ball's deepest place
    Real left = none;                            // peak-to-peak amplitude of the fifth period over the first peak
    Real speed = none;                           // m/s, root mean square of nodes in the last 0.1 s
    Real overlap = none, overlap_at_end = none;  // m, nodes in other bodies
    Real below_planes = none;                    // m, nodes in floor and walls
};

Measures measure(const PrecisionScene& scene, const Record& record);

}  // namespace skerry::profiling
