// Memory of columns: whole cache lines, and pages of 2 MiB for long columns if the system has them.
#pragma once

#include <cstddef>
#include <span>

#include "components/range.h"

namespace skerry {

/// Alignment of the rows of a column [bytes]. It is the size of the widest vector register and of a cache line, so that
/// no two columns share a line.
inline constexpr std::size_t row_alignment = 64;

/// Allocates `bytes`, which may be 0, with operator new. A step reads the columns of a large world once; with pages of
/// 4 kB the address translation takes 4 % of a step of 360,000 tetrahedra (docs/scaling.md). On Linux, memory that
/// spans whole pages of 2 MiB is therefore requested as such pages. Throws std::bad_alloc.
void* allocate_rows(std::size_t bytes);
void free_rows(void* memory) noexcept;

/// Rows of plain data whose type only the caller knows. Each row has `row_bytes` bytes, the same in every call. Rows
/// are copied bytewise and need no destructor. The memory never shrinks.
class RowMemory {
public:
    RowMemory() = default;
    RowMemory(const RowMemory&) = delete;
    RowMemory& operator=(const RowMemory&) = delete;
    ~RowMemory() { free_rows(rows_); }

    void* rows() const { return rows_; }
    std::size_t size() const { return size_; }
    std::size_t capacity() const { return capacity_; }

    /// Reserves memory for exactly `count` rows, if there is less.
    void reserve(std::size_t count, std::size_t row_bytes);
    /// Reserves memory for `more` rows behind the last row. The memory at least doubles, so that appending rows one by
    /// one moves each row only a few times.
    void make_room(std::size_t more, std::size_t row_bytes);
    /// Sets the number of rows to `count`. The caller must have reserved memory for the rows and must write the new
    /// ones.
    void set_size(std::size_t count) { size_ = count; }
    void copy(const RowMemory& other, std::size_t row_bytes);
    void swap(RowMemory& other) noexcept;
    /// Removes ascending ranges of rows. Parts of a range beyond the last row are ignored. Later rows move down in
    /// order, each once.
    void erase(std::span<const Range> gone, std::size_t row_bytes);
    void erase(std::size_t first, std::size_t count, std::size_t row_bytes);

private:
    void move_to_room_for(std::size_t count, std::size_t row_bytes);

    void* rows_ = nullptr;
    std::size_t size_ = 0, capacity_ = 0;  // in rows
};

}  // namespace skerry
