#include "components/row_memory.h"

#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace skerry {

namespace {

[[maybe_unused]] constexpr std::size_t large_page = std::size_t{2} << 20;

/// An advice: where it is refused, or there are no such pages, memory is as it was.
void ask_for_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t first = (begin + large_page - 1) / large_page * large_page,
                         end = (begin + bytes) / large_page * large_page;
    if (first < end) madvise(static_cast<std::byte*>(memory) + (first - begin), end - first, MADV_HUGEPAGE);
#endif
}

}  // namespace

void* allocate_rows(std::size_t bytes) {
    void* const memory = ::operator new (bytes, std::align_val_t{row_alignment});
    ask_for_large_pages(memory, bytes);
    return memory;
}

void free_rows(void* memory) noexcept {
    ::operator delete (memory, std::align_val_t{row_alignment});
}

}  // namespace skerry
