// What a comparison of eight lanes gives, and what is asked of it.
#pragma once

#include <cstdint>

#include "components/lanes.h"

namespace skerry {

/// By lane: all bits where it holds, else none. What comparing two Real8 gives.
typedef std::int64_t LaneBits __attribute__((vector_size(sizeof(Real8))));

/// All lanes or-ed together. By halves: as a loop over lanes it went through memory, and was a good part of a search.
[[gnu::always_inline]] inline std::int64_t any_bits(const LaneBits& mask) {
    const LaneBits four = mask | __builtin_shufflevector(mask, mask, 4, 5, 6, 7, 0, 1, 2, 3),
                   two = four | __builtin_shufflevector(four, four, 2, 3, 0, 1, 6, 7, 4, 5);
    return two[0] | two[1];
}

/// Bit l for lane l.
[[gnu::always_inline]] inline unsigned bits_of(const LaneBits& mask) {
    constexpr LaneBits bit{1, 2, 4, 8, 16, 32, 64, 128};
    return static_cast<unsigned>(any_bits(mask & bit));
}

}  // namespace skerry
