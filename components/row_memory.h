// Memory of columns. It begins at a cache line. Long columns get pages of 2 MiB if the system has them.
#pragma once

#include <cstddef>
#include <span>

#include "components/range.h"

namespace skerry {

/// Alignment of the rows of a column [bytes]: the size of the widest vector register and of a cache line. Two columns
/// therefore never share a cache line.
inline constexpr std::size_t row_alignment = 64;

/// Allocates `bytes` bytes (0 is allowed) with operator new. Throws std::bad_alloc. On Linux, memory that covers
/// complete pages of 2 MiB is requested as such pages: the TLB of a core cannot hold all pages of 4 kB of a large
/// scene, and address translation then takes 4 % of the time of a step (360,000 tetrahedra).
void* allocate_rows(std::size_t bytes);
void free_rows(void* memory) noexcept;

/// Rows of one column. Their type must be trivially copyable; only the caller knows it. `row_bytes` is the size of a
/// row [bytes] and must be the same in every call. Rows are copied bytewise and need no destructor. The memory never
/// shrinks.
class RowMemory {
public:
    RowMemory() = default;
    RowMemory(const RowMemory&) = delete;
    RowMemory& operator=(const RowMemory&) = delete;
    ~RowMemory() { free_rows(rows_); }

    void* rows() const { return rows_; }
    std::size_t size() const { return size_; }
    std::size_t capacity() const { return capacity_; }

    /// Reserves memory for exactly `count` rows if the present memory is smaller.
    void reserve(std::size_t count, std::size_t row_bytes);
    /// Reserves memory for `more` rows after the last row. New memory has room for at least twice the present number of
    /// rows, so that appending rows one by one copies each row only a few times.
    void make_room(std::size_t more, std::size_t row_bytes);
    /// Sets the number of rows to `count`. The caller must have reserved memory for `count` rows and must write the new
    /// rows.
    void set_size(std::size_t count) { size_ = count; }
    void copy(const RowMemory& other, std::size_t row_bytes);
    void swap(RowMemory& other) noexcept;
    /// Removes ascending ranges of rows. Parts of a range beyond the last row are ignored. Later rows close the gaps
    /// and keep their order; each row is moved at most once.
    void erase(std::span<const Range> erased, std::size_t row_bytes);
    void erase(std::size_t first, std::size_t count, std::size_t row_bytes);

private:
    void move_to_room_for(std::size_t count, std::size_t row_bytes);

    void* rows_ = nullptr;
    std::size_t size_ = 0, capacity_ = 0;  // number of rows in use, and number of rows for which there is memory
};

}  // namespace skerry
