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

/// Bitwise or of all lanes. The halves of the register are combined, because a loop over the lanes would store the
/// register in memory.
[[gnu::always_inline]] inline std::int64_t any_bits(const LaneBits& mask) {
    const LaneBits four = mask | __builtin_shufflevector(mask, mask, 4, 5, 6, 7, 0, 1, 2, 3),
                   two = four | __builtin_shufflevector(four, four, 2, 3, 0, 1, 6, 7, 4, 5);
    return two[0] | two[1];
}

/// Integer in which bit l is set if lane l of the mask is set. The conversion takes one instruction with AVX-512DQ.
[[gnu::always_inline]] inline unsigned bits_of(const LaneBits& mask) {
#if defined(__AVX512DQ__)
    typedef long long Signs __attribute__((vector_size(sizeof(LaneBits))));
    return static_cast<unsigned char>(__builtin_ia32_cvtq2mask512(__builtin_convertvector(mask, Signs)));
#else
    constexpr LaneBits bit{1, 2, 4, 8, 16, 32, 64, 128};
    return static_cast<unsigned>(any_bits(mask & bit));
#endif
}

/// Calls visit(l) for each set bit l, in ascending order.
void for_each_lane(unsigned bits, auto&& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace skerry
