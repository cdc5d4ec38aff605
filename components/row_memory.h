// Memory of columns: whole cache lines and, of long ones, pages of 2 MiB where the system has them.
#pragma once

#include <cstddef>
#include <span>

#include "components/range.h"

namespace skerry {

/// Bytes to which the rows of a column are aligned: a vector register, and a line that no other column shares.
inline constexpr std::size_t row_alignment = 64;

/// Memory of `bytes`, which may be 0, from operator new. A step goes through the columns of a large world once: with
/// pages of 4 kB looking up where each is takes 4 % of a step of 360,000 tetrahedra (docs/scaling.md). So Linux is
/// asked for pages of 2 MiB under what spans whole ones. Throws std::bad_alloc.
void* allocate_rows(std::size_t bytes);
void free_rows(void* memory) noexcept;

/// Rows of plain data whose type only the caller knows: each is `row_bytes` long, the same in every call. Copying its
/// bytes copies a row, and nothing has to be done when a row ends. Memory never shrinks.
class RowMemory {
public:
    RowMemory() = default;
    RowMemory(const RowMemory&) = delete;
    RowMemory& operator=(const RowMemory&) = delete;
    ~RowMemory() { free_rows(rows_); }

    void* rows() const { return rows_; }
    std::size_t size() const { return size_; }
    std::size_t capacity() const { return capacity_; }

    /// Room for `count` rows, and no more.
    void reserve(std::size_t count, std::size_t row_bytes);
    /// Room for `more` rows behind the last. Memory at least doubles, so that appending rows one by one moves each only
    /// a few times.
    void make_room(std::size_t more, std::size_t row_bytes);
    /// The first `count` rows; the caller has made room for them, and writes those that are new.
    void set_size(std::size_t count) { size_ = count; }
    void copy(const RowMemory& other, std::size_t row_bytes);
    void swap(RowMemory& other) noexcept;
    /// Removes ranges of rows, ascending. Parts of a range beyond the last row are ignored. Later rows move down in
    /// order, each once.
    void erase(std::span<const Range> gone, std::size_t row_bytes);
    void erase(std::size_t first, std::size_t count, std::size_t row_bytes);

private:
    void move_to_room_for(std::size_t count, std::size_t row_bytes);

    void* rows_ = nullptr;
    std::size_t size_ = 0, capacity_ = 0;  // in rows
};

}  // namespace skerry
