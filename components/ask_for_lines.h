// Prefetching.
#pragma once

#include <cstddef>

namespace skerry {

/// Prefetches the cache lines of `count` items and does not wait for the data. The compiler unrolls the loop completely
/// if `count` is a small constant.
template <class T>
[[gnu::always_inline]] inline void ask_for_lines(const T* first, std::size_t count) {
    constexpr std::size_t line = 64;
    const char* const bytes = reinterpret_cast<const char*>(first);
#pragma GCC unroll 16
    for (std::size_t at = 0; at < count * sizeof(T); at += line) __builtin_prefetch(bytes + at);
}

}  // namespace skerry
