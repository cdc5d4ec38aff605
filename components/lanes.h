// Lanes<T, W>: W rows side by side, so that a kernel loads W values of one field at once, and Real8, the register they
// are loaded into.
#pragma once

#include <cstddef>
#include <cstring>

#include "components/types.h"

namespace skerry {

/// Elements worked on side by side: 8 doubles fill one 512-bit register, or two of 256 bits.
inline constexpr int element_lanes = 8;

template <class T, int W>
struct alignas(sizeof(T) * W <= 64 ? sizeof(T) * W : 64) Lanes {
    T lane[W];

    T& operator[](std::size_t i) { return lane[i]; }
    const T& operator[](std::size_t i) const { return lane[i]; }
};

/// element_lanes reals in one register, or in two or four on older machines. A vector type of the compiler instead of a
/// loop over Lanes: it does not depend on the vectoriser's luck, and every lane gets the bits that the same source
/// gives for one Real.
typedef Real Real8 __attribute__((vector_size(sizeof(Real) * element_lanes)));

inline Real8 load(const Lanes<Real, element_lanes>& from) {
    Real8 to;
    std::memcpy(&to, from.lane, sizeof to);
    return to;
}

inline void store(const Real8& from, Lanes<Real, element_lanes>& to) {
    std::memcpy(to.lane, &from, sizeof from);
}

}  // namespace skerry
