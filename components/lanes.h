// Lanes<T, W>: W values side by side, so that a kernel loads W values of one field at once. Real8: the register that
// holds the loaded values.
#pragma once

#include <cstddef>

#include "components/types.h"

namespace skerry {

/// Number of elements processed side by side: 8 doubles fill one 512-bit register, or two of 256 bits.
inline constexpr int element_lanes = 8;

template <class T, int W>
struct alignas(sizeof(T) * W <= 64 ? sizeof(T) * W : 64) Lanes {
    T lane[W];

    T& operator[](std::size_t i) { return lane[i]; }
    const T& operator[](std::size_t i) const { return lane[i]; }
};

/// element_lanes reals in one register, or in two or four on older machines. A vector type of the compiler is used
/// instead of a loop over Lanes: it does not depend on auto-vectorisation, and every lane gets the bits that the same
/// source gives for one Real.
typedef Real Real8 __attribute__((vector_size(sizeof(Real) * element_lanes)));

/// Half of a Real8.
typedef Real Real4 __attribute__((vector_size(sizeof(Real) * element_lanes / 2)));

// Types for loads from the address of any Real: unaligned, and may alias other reals. memcpy is avoided: without
// 512-bit registers it becomes copies of 16 bytes, and a load of 32 bytes right after the copies has to wait for them.
typedef Real Real8InMemory __attribute__((vector_size(sizeof(Real8)), aligned(alignof(Real)), may_alias));
typedef Real Real4InMemory __attribute__((vector_size(sizeof(Real4)), aligned(alignof(Real)), may_alias));

/// Vector type of the element force kernel: as many reals as a register holds.
#ifdef __AVX512VL__  // tested instead of __AVX512F__, which cmake/flags.cmake hides from Eigen
using KernelReal = Real8;
#else
using KernelReal = Real4;
#endif
template <class T>
inline constexpr std::size_t lanes_of = sizeof(T) / sizeof(Real);
inline constexpr std::size_t kernel_parts = element_lanes / lanes_of<KernelReal>;  // of a block

[[gnu::always_inline]] inline Real4 half_at(const Real* from) {
    return *reinterpret_cast<const Real4InMemory*>(from);
}
[[gnu::always_inline]] inline void store_half(const Real4& from, Real* to) {
    *reinterpret_cast<Real4InMemory*>(to) = from;
}

[[gnu::always_inline]] inline Real8 load(const Lanes<Real, element_lanes>& from) {
    return *reinterpret_cast<const Real8InMemory*>(from.lane);
}

[[gnu::always_inline]] inline void store(const Real8& from, Lanes<Real, element_lanes>& to) {
    *reinterpret_cast<Real8InMemory*>(to.lane) = from;
}

/// Loads part `part` of the lanes of a block; for T = Real8 all lanes.
template <class T>
[[gnu::always_inline]] inline T load_part(const Lanes<Real, element_lanes>& from, std::size_t part) {
    if constexpr (lanes_of<T> == element_lanes)
        return load(from);
    else
        return half_at(from.lane + part * lanes_of<T>);
}
template <class T>
[[gnu::always_inline]] inline void store_part(const T& from, Lanes<Real, element_lanes>& to, std::size_t part) {
    if constexpr (lanes_of<T> == element_lanes)
        store(from, to);
    else
        store_half(from, to.lane + part * lanes_of<T>);
}

}  // namespace skerry
