// Candidates that crossings are looked for among (systems/collision/inputs/contact_reach.h, 4).
#pragma once

#include <cstdint>
#include <span>

#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Of a range, those that can have met by `travel_bound`: `test(c)` says whether it had to look. Returns how many it
/// looked at.
std::uint64_t count_tested(std::span<const Real> asleep_until, Range range, Real travel_bound, auto&& test) {
    std::uint64_t tested = 0;
    for (Index c = range.begin; c < range.end; ++c)
        if (!(travel_bound < asleep_until[static_cast<std::size_t>(c)])) tested += test(c);
    return tested;
}

}  // namespace skerry
