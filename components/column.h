// Column<T>: one field of a table, contiguous and 64-byte aligned.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include "components/access_check.h"
#include "components/range.h"
#include "components/row_memory.h"

namespace skerry {

/// A field of a table: rows of plain data. A column grows like std::vector. It keeps its memory when rows are removed,
/// so that later steps reuse the memory instead of allocating. New rows made by resize are value-initialised.
template <class T>
class Column {
public:
    using value_type = T;

    Column() {
        static_assert(std::is_trivially_destructible_v<T>,
                      "rows must be trivially destructible, because RowMemory copies them byte by byte");
    }
    Column(const Column& other) : copies_(other.copies_) { memory_.copy(other.memory_, sizeof(T)); }
    Column(Column&& other) noexcept : copies_(std::move(other.copies_)) { memory_.swap(other.memory_); }
    Column& operator=(const Column& other) {
        copies_ = other.copies_;
        memory_.copy(other.memory_, sizeof(T));
        return *this;
    }
    Column& operator=(Column&& other) noexcept {
        copies_ = std::move(other.copies_);
        RowMemory old;
        old.swap(memory_);
        memory_.swap(other.memory_);
        return *this;
    }
    ~Column() = default;

    std::size_t size() const { return seen().size(); }
    bool empty() const { return seen().size() == 0; }
    T* data() { return rows(changed()); }
    const T* data() const { return rows(seen()); }
    T& operator[](std::size_t row) { return data()[row]; }
    const T& operator[](std::size_t row) const { return data()[row]; }
    T* begin() { return data(); }
    T* end() { return data() + memory_.size(); }
    const T* begin() const { return data(); }
    const T* end() const { return data() + memory_.size(); }
    T& back() { return *(end() - 1); }
    const T& back() const { return *(end() - 1); }

    void resize(std::size_t count) {
        append(count, [](T* row) { ::new (static_cast<void*>(row)) T(); });
    }
    void resize(std::size_t count, const T& value) {
        append(count, [kept = value](T* row) { ::new (static_cast<void*>(row)) T(kept); });
    }
    void assign(std::size_t count, const T& value) {
        const T kept = value;
        clear();
        memory_.reserve(count, sizeof(T));
        resize(count, kept);
    }
    void reserve(std::size_t count) { changed().reserve(count, sizeof(T)); }
    void clear() { changed().set_size(0); }
    void push_back(const T& value) {
        RowMemory& memory = changed();
        if (memory.size() < memory.capacity()) {
            ::new (static_cast<void*>(rows(memory) + memory.size())) T(value);
        } else {
            const T kept = value;  // copied first, because `value` may be a row of this column
            memory.make_room(1, sizeof(T));
            ::new (static_cast<void*>(rows(memory) + memory.size())) T(kept);
        }
        memory.set_size(memory.size() + 1);
    }
    /// Removes `count` rows, beginning with row `first`. Later rows move to lower indices and keep their order.
    void erase(std::size_t first, std::size_t count) { changed().erase(first, count, sizeof(T)); }
    /// Removes ranges of rows in ascending order, in one pass. Parts of a range beyond the last row are ignored.
    void erase(std::span<const Range> erased) { changed().erase(erased, sizeof(T)); }
    void swap(Column& other) noexcept { changed().swap(other.changed()); }

    std::span<T> span() { return {data(), memory_.size()}; }
    std::span<const T> span() const { return {data(), memory_.size()}; }

private:
    friend class AnyColumn;

    static T* rows(const RowMemory& memory) { return static_cast<T*>(memory.rows()); }

    // All accesses to the rows call seen() or changed(), which check the access if checks are enabled. Both functions
    // are always inlined, so that without checks they cost nothing, even in a build without optimisation.
    [[gnu::always_inline]] const RowMemory& seen() const {
        if constexpr (access_is_checked) check_access(this, sizeof *this, false);
        return memory_;
    }
    [[gnu::always_inline]] RowMemory& changed() {
        if constexpr (access_is_checked) check_access(this, sizeof *this, true);
        return memory_;
    }

    void append(std::size_t count, auto&& make) {
        RowMemory& memory = changed();
        const std::size_t before = memory.size();
        if (count > before) {
            memory.make_room(count - before, sizeof(T));
            T* const end = rows(memory) + count;
            for (T* row = rows(memory) + before; row != end; ++row) make(row);
        }
        memory.set_size(count);
    }

    RowMemory memory_;
    [[no_unique_address]] CopyCheck copies_;
};

template <class T>
void swap(Column<T>& a, Column<T>& b) noexcept {
    a.swap(b);
}

}  // namespace skerry
