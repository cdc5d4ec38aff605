// Prefetching.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skerry {

/// Prefetches the cache lines of `count` items and does not wait for the data. The compiler unrolls the loop completely
/// if `count` is a small constant.
template <class T>
[[gnu::always_inline]] inline void prefetch_lines(const T* first, std::size_t count) {
    constexpr std::size_t line = 64;
    const char* const bytes = reinterpret_cast<const char*>(first);
#pragma GCC unroll 16
    for (std::size_t at = 0; at < count * sizeof(T); at += line) __builtin_prefetch(bytes + at);
}

/// Prefetches the cache lines of `count` items that come `ahead` items after `current`. The items may be past the end
/// of the array, because a prefetch never faults.
template <class T>
[[gnu::always_inline]] inline void prefetch_lines_ahead(const T* current, std::size_t ahead, std::size_t count) {
    // The address is computed as an integer, because pointer arithmetic past the end of the array is undefined.
    prefetch_lines(reinterpret_cast<const T*>(reinterpret_cast<std::uintptr_t>(current) + ahead * sizeof(T)), count);
}

}  // namespace skerry
