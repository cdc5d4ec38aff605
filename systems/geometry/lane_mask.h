// Masks that result from comparisons of eight lanes, and operations on such masks.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "components/lanes.h"

namespace skerry {

/// Result of comparing two Real8. In each lane, all bits are set if the comparison is true, and no bit is set
/// otherwise.
typedef std::int64_t LaneBits __attribute__((vector_size(sizeof(Real8))));

/// Result of comparing two Real4.
typedef std::int64_t HalfBits __attribute__((vector_size(sizeof(Real4))));

/// Integer in which bit l is set if lane l of the mask is set. The conversion takes one instruction with AVX.
[[gnu::always_inline]] inline unsigned bits_of(const HalfBits& mask) {
#if defined(__BMI2__)  // stands for AVX, because cmake/flags.cmake undefines __AVX__ to hide it from Eigen
    return static_cast<unsigned>(__builtin_ia32_movmskpd256(reinterpret_cast<Real4>(mask)));
#else
    // The halves of the register are combined, because a loop over the lanes would store the register in memory.
    constexpr HalfBits bit{1, 2, 4, 8};
    const HalfBits all = mask & bit, two = all | __builtin_shufflevector(all, all, 2, 3, 0, 1);
    return static_cast<unsigned>(two[0] | two[1]);
#endif
}
/// Integer of eight bits for a mask of eight lanes. The conversion takes one instruction with AVX-512DQ.
[[gnu::always_inline]] inline unsigned bits_of(const LaneBits& mask) {
#if defined(__AVX512DQ__)
    typedef long long Signs __attribute__((vector_size(sizeof(LaneBits))));
    return static_cast<unsigned char>(__builtin_ia32_cvtq2mask512(__builtin_convertvector(mask, Signs)));
#else
    const HalfBits low = __builtin_shufflevector(mask, mask, 0, 1, 2, 3),
                   high = __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
    return bits_of(low) | bits_of(high) << 4;
#endif
}

/// Bit mask of a comparison of eight lanes, which fill kernel_parts registers. compare(part) returns the mask of the
/// lanes in register `part`. The lanes are compared register by register, because the compiler would compare a vector
/// that is wider than a register lane by lane.
template <class Compare>
[[gnu::always_inline]] inline unsigned bits_of_parts(Compare&& compare) {
    unsigned bits = 0;
    for (std::size_t part = 0; part < kernel_parts; ++part)
        bits |= bits_of(compare(part)) << part * lanes_of<KernelReal>;
    return bits;
}

/// Calls visit(l) for each set bit l, in ascending order.
void for_each_lane(unsigned bits, auto&& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace skerry
