// Column<T>: one field of a table, contiguous and 64-byte aligned.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace skerry {

/// Allocates on cache-line boundaries, so that a column starts a vector register and shares no line with another.
template <class T>
struct AlignedAllocator {
    using value_type = T;
    static constexpr std::align_val_t alignment{64};

    AlignedAllocator() = default;
    template <class U>
    AlignedAllocator(const AlignedAllocator<U>&) {}

    T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
    void deallocate(T* memory, std::size_t) { ::operator delete(memory, alignment); }

    template <class U>
    bool operator==(const AlignedAllocator<U>&) const {
        return true;
    }
};

/// A field of a table: rows of plain data. Grows like a vector and never shrinks its memory, so that a steady state allocates
/// nothing. Rows made by resize are value-initialised.
template <class T>
class Column {
public:
    using value_type = T;

    std::size_t size() const { return rows_.size(); }
    bool empty() const { return rows_.empty(); }
    T* data() { return rows_.data(); }
    const T* data() const { return rows_.data(); }
    T& operator[](std::size_t row) { return rows_[row]; }
    const T& operator[](std::size_t row) const { return rows_[row]; }
    auto begin() { return rows_.begin(); }
    auto end() { return rows_.end(); }
    auto begin() const { return rows_.begin(); }
    auto end() const { return rows_.end(); }
    T& back() { return rows_.back(); }
    const T& back() const { return rows_.back(); }

    void resize(std::size_t count) { rows_.resize(count); }
    void resize(std::size_t count, const T& value) { rows_.resize(count, value); }
    void assign(std::size_t count, const T& value) { rows_.assign(count, value); }
    void reserve(std::size_t count) { rows_.reserve(count); }
    void clear() { rows_.clear(); }
    void push_back(const T& value) { rows_.push_back(value); }
    /// Removes `count` rows from `first` on; later rows move down in order.
    void erase(std::size_t first, std::size_t count) {
        rows_.erase(rows_.begin() + static_cast<std::ptrdiff_t>(first), rows_.begin() + static_cast<std::ptrdiff_t>(first + count));
    }
    void swap(Column& other) noexcept { rows_.swap(other.rows_); }

    std::span<T> span() { return {rows_.data(), rows_.size()}; }
    std::span<const T> span() const { return {rows_.data(), rows_.size()}; }

private:
    std::vector<T, AlignedAllocator<T>> rows_;
};

template <class T>
void swap(Column<T>& a, Column<T>& b) noexcept {
    a.swap(b);
}

}  // namespace skerry
