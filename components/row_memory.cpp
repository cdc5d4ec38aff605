#include "components/row_memory.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>
#include <utility>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace skerry {

namespace {

[[maybe_unused]] constexpr std::size_t large_page = std::size_t{2} << 20;

/// Asks the system for large pages. If the system refuses, the memory keeps its small pages.
void request_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
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
    request_large_pages(memory, bytes);
    return memory;
}

void free_rows(void* memory) noexcept {
    ::operator delete (memory, std::align_val_t{row_alignment});
}

void RowMemory::move_to_room_for(std::size_t count, std::size_t row_bytes) {
    if (count > static_cast<std::size_t>(PTRDIFF_MAX) / row_bytes) throw std::bad_array_new_length();
    void* const memory = allocate_rows(count * row_bytes);
    if (size_ > 0) std::memcpy(memory, rows_, size_ * row_bytes);
    free_rows(rows_);
    rows_ = memory;
    capacity_ = count;
}

void RowMemory::reserve(std::size_t count, std::size_t row_bytes) {
    if (count > capacity_) move_to_room_for(count, row_bytes);
}

void RowMemory::make_room(std::size_t more, std::size_t row_bytes) {
    if (more > capacity_ - size_) move_to_room_for(size_ + std::max(size_, more), row_bytes);
}

void RowMemory::copy(const RowMemory& other, std::size_t row_bytes) {
    if (this == &other) return;
    if (other.size_ > capacity_) {
        RowMemory larger;
        larger.reserve(other.size_, row_bytes);
        swap(larger);
    }
    size_ = other.size_;
    if (size_ > 0) std::memcpy(rows_, other.rows_, size_ * row_bytes);
}

void RowMemory::swap(RowMemory& other) noexcept {
    std::swap(rows_, other.rows_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
}

void RowMemory::erase(std::span<const Range> erased, std::size_t row_bytes) {
    const auto clamped = [&](Index row) { return std::min(static_cast<std::size_t>(row), size_); };
    if (erased.empty() || clamped(erased.front().begin) == size_) return;
    auto* const rows = static_cast<std::byte*>(rows_);
    std::size_t to = clamped(erased.front().begin);
    for (std::size_t i = 0; i < erased.size(); ++i) {
        const std::size_t from = clamped(erased[i].end),
                          end = i + 1 < erased.size() ? clamped(erased[i + 1].begin) : size_;
        if (from == end) continue;
        std::memmove(rows + to * row_bytes, rows + from * row_bytes, (end - from) * row_bytes);
        to += end - from;
    }
    size_ = to;
}

void RowMemory::erase(std::size_t first, std::size_t count, std::size_t row_bytes) {
    auto* const to = static_cast<std::byte*>(rows_) + first * row_bytes;
    if (const std::size_t left = size_ - first - count; left > 0)
        std::memmove(to, to + count * row_bytes, left * row_bytes);
    size_ -= count;
}

}  // namespace skerry
