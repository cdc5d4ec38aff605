// Conservative advancement: the time until two moving shapes come near contact (docs/methods/collision.md 7.2).
#pragma once

#include <optional>

#include "components/types.h"

namespace skerry {

/// Time in [0, 1] at which a gap has fallen to `near` [m], or nothing if it does not. `gap`: that at the start.
/// `free_time(gap, time)`: time after `time` in which certainly nothing meets, infinite without motion. `gap_at(time)`:
/// gap at a later time. After some thousand rounds the search gives up and returns the time reached: shapes that need
/// more roll over each other at a distance too small to be resolved in a step.
std::optional<Real> advance_conservatively(Real gap, Real near, auto&& free_time, auto&& gap_at) {
    constexpr Real part = 0.9;  // of the free time. The rest keeps the shapes apart in spite of rounding.
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
