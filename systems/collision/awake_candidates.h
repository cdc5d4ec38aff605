// Selection of the candidates that are tested for crossings (systems/collision/inputs/contact_reach.h, 4).
#pragma once

#include <cstdint>
#include <span>

#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Calls `test(c)` for those candidates of a range that can have met by `travel_bound` [m]. `test` returns true if it
/// needed a full test. Returns the number of full tests.
std::uint64_t count_tested(std::span<const Real> asleep_until, Range range, Real travel_bound, auto&& test) {
    std::uint64_t tested = 0;
    for (Index c = range.begin; c < range.end; ++c)
        if (!(travel_bound < asleep_until[static_cast<std::size_t>(c)])) tested += test(c);
    return tested;
}

}  // namespace skerry
