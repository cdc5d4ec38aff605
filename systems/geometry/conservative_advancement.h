// Conservative advancement: the time until two moving shapes come near contact (docs/methods/collision.md 7.2).
#pragma once

#include <optional>

#include "components/types.h"

namespace skerry {

/// Time in [0, 1] at which the gap between two shapes has fallen to `near` [m] or less, but is still positive; no value
/// if the gap stays larger than `near`.
/// - `gap`: gap at time 0 [m]
/// - `gap_at(time)`: gap at a later time [m]
/// - `free_time(gap, time)`: duration after `time` in which the shapes certainly do not meet; infinite without motion
///
/// After 4096 iterations the search gives up and returns the time reached. Shapes that need so many iterations roll
/// over each other at a distance too small to be resolved in a step.
std::optional<Real> advance_conservatively(Real gap, Real near, auto&& free_time, auto&& gap_at) {
    // Fraction of the free time used per iteration; the remainder keeps the shapes apart in spite of rounding errors.
    constexpr Real part = 0.9;
    constexpr int most_rounds = 4096;
    Real time = 0;
    for (int round = 0; round < most_rounds && gap > near; ++round) {
        time += part * free_time(gap, time);
        if (!(time <= 1)) return std::nullopt;
        gap = gap_at(time);
    }
    return time;
}

}  // namespace skerry
