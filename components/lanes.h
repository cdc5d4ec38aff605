// Lanes<T, W>: W values side by side in memory, so that a kernel loads W values of one field at once. Real8: the vector
// type of the loaded values.
#pragma once

#include <array>
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

/// A vector of element_lanes reals. It fills one register, or two or four on older machines. Unlike a loop over Lanes,
/// a vector type of the compiler does not depend on auto-vectorisation. Every lane gets bitwise the result of the same
/// source code for a single Real.
typedef Real Real8 __attribute__((vector_size(sizeof(Real) * element_lanes)));

/// Half of the lanes of a Real8.
typedef Real Real4 __attribute__((vector_size(sizeof(Real) * element_lanes / 2)));

// Vectors of single precision: Float8 has one number for each of the eight lanes of a block, Float4 one for each of
// four lanes.
typedef float Float8 __attribute__((vector_size(sizeof(float) * element_lanes)));
typedef float Float4 __attribute__((vector_size(sizeof(float) * element_lanes / 2)));

// Types for loads of vectors from the address of any Real. They need no alignment and may alias other reals. memcpy
// would be slower without 512-bit registers: it copies 16 bytes at a time to a temporary variable, and a load of 32
// bytes from this variable has to wait.
typedef Real Real8InMemory __attribute__((vector_size(sizeof(Real8)), aligned(alignof(Real)), may_alias));
typedef Real Real4InMemory __attribute__((vector_size(sizeof(Real4)), aligned(alignof(Real)), may_alias));
typedef float Float8InMemory __attribute__((vector_size(sizeof(Float8)), may_alias));

/// Vector type of the element force kernel: a vector that fits into one register.
#ifdef __AVX512VL__  // tested instead of __AVX512F__, which cmake/flags.cmake hides from Eigen
using KernelReal = Real8;
#else
using KernelReal = Real4;
#endif
template <class T>
inline constexpr std::size_t lanes_of = sizeof(T) / sizeof(Real);
// number of KernelReal vectors that hold the lanes of one block
inline constexpr std::size_t kernel_parts = element_lanes / lanes_of<KernelReal>;
/// One T for each KernelReal of a block: one T if a register holds all eight lanes, two if it holds four.
template <class T>
using Parts = std::array<T, kernel_parts>;

[[gnu::always_inline]] inline Real4 half_at(const Real* from) {
    return *reinterpret_cast<const Real4InMemory*>(from);
}
[[gnu::always_inline]] inline void store_half(const Real4& from, Real* to) {
    *reinterpret_cast<Real4InMemory*>(to) = from;
}

[[gnu::always_inline]] inline Real8 load(const Lanes<Real, element_lanes>& from) {
    return *reinterpret_cast<const Real8InMemory*>(from.lane);
}

/// Loads numbers of single precision as reals.
inline Real8 load_reals(const Lanes<float, element_lanes>& from) {
    return __builtin_convertvector(static_cast<Float8>(*reinterpret_cast<const Float8InMemory*>(from.lane)), Real8);
}

[[gnu::always_inline]] inline void store(const Real8& from, Lanes<Real, element_lanes>& to) {
    *reinterpret_cast<Real8InMemory*>(to.lane) = from;
}

/// Loads one T from the eight lanes of a block: all lanes for a Real8; lanes 0 to 3 (part 0) or 4 to 7 (part 1) for a
/// Real4.
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
