// Column<T>: one field of a table, contiguous and 64-byte aligned.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "components/access_check.h"
#include "components/range.h"
#include "components/row_memory.h"

namespace skerry {

/// Allocates as row_memory.h says.
template <class T>
struct AlignedAllocator {
    using value_type = T;
    AlignedAllocator() = default;
    template <class U>
    AlignedAllocator(const AlignedAllocator<U>&) {}

    T* allocate(std::size_t count) { return static_cast<T*>(allocate_rows(count * sizeof(T))); }
    void deallocate(T* memory, std::size_t) { free_rows(memory); }

    template <class U>
    bool operator==(const AlignedAllocator<U>&) const {
        return true;
    }
};

/// A field of a table: rows of plain data. Grows like a vector and never shrinks its memory, so that a steady state
/// allocates nothing. Rows made by resize are value-initialised.
template <class T>
class Column {
public:
    using value_type = T;

    std::size_t size() const { return seen().size(); }
    bool empty() const { return seen().empty(); }
    T* data() { return changed().data(); }
    const T* data() const { return seen().data(); }
    T& operator[](std::size_t row) { return changed()[row]; }
    const T& operator[](std::size_t row) const { return seen()[row]; }
    auto begin() { return changed().begin(); }
    auto end() { return changed().end(); }
    auto begin() const { return seen().begin(); }
    auto end() const { return seen().end(); }
    T& back() { return changed().back(); }
    const T& back() const { return seen().back(); }

    void resize(std::size_t count) { changed().resize(count); }
    void resize(std::size_t count, const T& value) { changed().resize(count, value); }
    void assign(std::size_t count, const T& value) { changed().assign(count, value); }
    void reserve(std::size_t count) { changed().reserve(count); }
    void clear() { changed().clear(); }
    void push_back(const T& value) { changed().push_back(value); }
    /// Removes `count` rows from `first` on; later rows move down in order.
    void erase(std::size_t first, std::size_t count) {
        Rows& rows = changed();
        rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(first),
                   rows.begin() + static_cast<std::ptrdiff_t>(first + count));
    }
    /// Removes ranges of rows, ascending; what of them is beyond the end is not there. One pass over the rows behind.
    void erase(std::span<const Range> gone) {
        if (gone.empty() || static_cast<std::size_t>(gone.front().begin) >= size()) return;
        Rows& rows = changed();
        const auto place = [&](Index row) {
            return rows.begin() + std::min(static_cast<std::ptrdiff_t>(row), static_cast<std::ptrdiff_t>(rows.size()));
        };
        auto to = place(gone.front().begin);
        for (std::size_t i = 0; i < gone.size(); ++i)
            to = std::move(place(gone[i].end), i + 1 < gone.size() ? place(gone[i + 1].begin) : rows.end(), to);
        rows.erase(to, rows.end());
    }
    void swap(Column& other) noexcept { changed().swap(other.changed()); }

    std::span<T> span() { return {changed().data(), rows_.size()}; }
    std::span<const T> span() const { return {seen().data(), rows_.size()}; }

private:
    using Rows = std::vector<T, AlignedAllocator<T>>;

    // The only ways to the rows: here the access is checked, where it is. Always inlined: nothing remains of them where
    // it is not, also in a build that does not optimise.
    [[gnu::always_inline]] const Rows& seen() const {
        if constexpr (access_is_checked) check_access(this, sizeof *this, false);
        return rows_;
    }
    [[gnu::always_inline]] Rows& changed() {
        if constexpr (access_is_checked) check_access(this, sizeof *this, true);
        return rows_;
    }

    Rows rows_;
    [[no_unique_address]] CopyCheck copies_;
};

template <class T>
void swap(Column<T>& a, Column<T>& b) noexcept {
    a.swap(b);
}

}  // namespace skerry
