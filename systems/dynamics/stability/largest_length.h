// The greatest length among many vectors, several at a time.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "components/types.h"

namespace skerry {

/// Greatest squared length of `count` vectors, where component(3 n + i) is component i of vector n. Infinite or not a
/// number as soon as one of them is: bit patterns of squares order as the squares do, with what is not finite on top.
/// Compared as integers, which no order of comparisons changes, they go through the lanes of a register; as numbers
/// they would wait for each other.
template <class Component>
[[gnu::always_inline]] inline Real largest_squared_length(std::size_t count, Component&& component) {
    std::uint64_t largest = 0;
#pragma omp simd reduction(max : largest)
    for (std::size_t n = 0; n < count; ++n) {
        const Real x = component(3 * n), y = component(3 * n + 1), z = component(3 * n + 2);
        const auto bits = std::bit_cast<std::uint64_t>(x * x + y * y + z * z);
        largest = bits > largest ? bits : largest;
    }
    return std::bit_cast<Real>(largest);
}

}  // namespace skerry
