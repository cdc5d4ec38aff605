// Lanes<T, W>: W rows side by side, so that a kernel loads W values of one field at once.
#pragma once

#include <cstddef>

namespace skerry {

/// Elements worked on side by side: 8 doubles fill one 512-bit register, or two of 256 bits.
inline constexpr int element_lanes = 8;

template <class T, int W>
struct alignas(sizeof(T) * W <= 64 ? sizeof(T) * W : 64) Lanes {
    T lane[W];

    T& operator[](std::size_t i) { return lane[i]; }
    const T& operator[](std::size_t i) const { return lane[i]; }
};

}  // namespace skerry
