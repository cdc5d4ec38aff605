// Finds the greatest length among many vectors, several vectors at a time.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "components/types.h"

namespace skerry {

/// Greatest squared length of the differences of `count` vectors from `origin`; infinite or NaN if one of the squared
/// lengths is. component(3 n + i) is component i of vector n.
///
/// The squares are compared as integers, because their bit patterns have the same order, with non-finite values on top.
/// Unlike comparisons of floating-point numbers, those of integers need not wait for each other.
template <class Component>
[[gnu::always_inline]] inline Real largest_squared_length(std::size_t count, Component&& component,
                                                          const Vec3& origin = Vec3::Zero()) {
    std::uint64_t largest = 0;
    const Real x0 = origin[0], y0 = origin[1], z0 = origin[2];
#pragma omp simd reduction(max : largest)
    for (std::size_t n = 0; n < count; ++n) {
        const Real x = component(3 * n) - x0, y = component(3 * n + 1) - y0, z = component(3 * n + 2) - z0;
        const auto bits = std::bit_cast<std::uint64_t>(x * x + y * y + z * z);
        largest = bits > largest ? bits : largest;
    }
    return std::bit_cast<Real>(largest);
}

/// Greatest squared length of the vectors, and of the vectors minus `origin`. `component` must be passed by value:
/// through a reference the loop is not vectorised.
template <class Component>
[[gnu::always_inline]] inline std::array<Real, 2> largest_squared_lengths(std::size_t count, Component component,
                                                                          const Vec3& origin) {
    std::uint64_t largest = 0, largest_less = 0;
    const Real x0 = origin[0], y0 = origin[1], z0 = origin[2];
#pragma omp simd reduction(max : largest, largest_less)
    for (std::size_t n = 0; n < count; ++n) {
        const Real x = component(3 * n), y = component(3 * n + 1), z = component(3 * n + 2);
        const Real dx = x - x0, dy = y - y0, dz = z - z0;
        const auto bits = std::bit_cast<std::uint64_t>(x * x + y * y + z * z);
        const auto less = std::bit_cast<std::uint64_t>(dx * dx + dy * dy + dz * dz);
        largest = bits > largest ? bits : largest;
        largest_less = less > largest_less ? less : largest_less;
    }
    return {std::bit_cast<Real>(largest), std::bit_cast<Real>(largest_less)};
}

}  // namespace skerry
