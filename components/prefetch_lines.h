// Prefetching of array items into the caches.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skerry {

/// Level of the caches that a prefetch fills. The values are those of the argument `locality` of __builtin_prefetch.
enum class CacheLevel { l1 = 3, l2 = 2 };

/// Prefetches the cache lines of `count` items and does not wait for the data. The compiler unrolls the loop completely
/// if `count` is a small constant.
template <CacheLevel level = CacheLevel::l1, class T>
[[gnu::always_inline]] inline void prefetch_lines(const T* first, std::size_t count) {
    constexpr std::size_t line = 64;
    const char* const bytes = reinterpret_cast<const char*>(first);
#pragma GCC unroll 16
    for (std::size_t at = 0; at < count * sizeof(T); at += line)
        __builtin_prefetch(bytes + at, 0, static_cast<int>(level));
}

/// Prefetches into the L2 cache the lines of `count` items that come `ahead` items after `current`. The items may be
/// past the end of the array, because a prefetch never faults.
///
/// The L1 cache is too small for data that a loop needs many iterations later, and has few buffers for outstanding
/// misses: with prefetches into L1, the elastic kernel would take 1.5 times as long for data in memory
/// (`profile_elements`, mesh `large`).
template <class T>
[[gnu::always_inline]] inline void prefetch_lines_ahead(const T* current, std::size_t ahead, std::size_t count) {
    // The address is computed as an integer, because pointer arithmetic past the end of the array is undefined.
    const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(current) + ahead * sizeof(T);
    prefetch_lines<CacheLevel::l2>(reinterpret_cast<const T*>(address), count);
}

}  // namespace skerry
