// Ragged<T>: rows of different lengths, stored as offsets and items.
#pragma once

#include <span>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Read-only view of a Ragged.
template <class T>
struct RaggedView {
    // Index in `item` of the first item of each row; last entry: number of items. The span has row_count + 1 entries.
    std::span<const Index> offset;
    std::span<const T> item;

    std::size_t size() const { return offset.empty() ? 0 : offset.size() - 1; }
    std::span<const T> operator[](std::size_t row) const {
        return item.subspan(static_cast<std::size_t>(offset[row]),
                            static_cast<std::size_t>(offset[row + 1] - offset[row]));
    }
};

/// Rows of different lengths. Row r consists of item[offset[r]] .. item[offset[r + 1] - 1].
template <class T>
struct Ragged {
    // Index in `item` of the first item of each row; last entry: number of items. The column has row_count + 1 entries,
    // or none if there are no rows.
    Column<Index> offset;
    Column<T> item;

    std::size_t size() const { return offset.empty() ? 0 : offset.size() - 1; }
    std::span<const T> operator[](std::size_t row) const { return view()[row]; }
    RaggedView<T> view() const { return {offset, item}; }
    void clear() {
        offset.clear();
        item.clear();
    }
};

}  // namespace skerry
