// Appends copies of the rows of a body for another body with the same mesh.
#pragma once

#include <array>
#include <cstddef>

#include "components/column.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Differences of row indices: row of a body minus the corresponding row of an earlier body with the same mesh.
struct RowOffsets {
    // `nodes`: offset of rows of NodeTable. `elements`: offset of the indices that tetrahedra have in
    // TetrahedronBlockTable.
    Index nodes, elements;
    Index triangles = 0, edges = 0, vertices = 0;
};

/// Adds `offset` to a row index; the value no_index is not changed.
inline void add_offset(Index& row, Index offset) {
    if (row != no_index) row += offset;
}
template <std::size_t count>
void add_offset(std::array<Index, count>& rows, Index offset) {
    for (Index& row : rows) add_offset(row, offset);
}

/// Appends copies of the rows in the range `rows` to the column. change(row) is applied to each copy before the copy is
/// stored.
template <class T>
void append_copies(Column<T>& column, Range rows, auto&& change) {
    const std::size_t first = column.size(), count = static_cast<std::size_t>(rows.size());
    column.resize(first + count);
    for (std::size_t i = 0; i < count; ++i) {
        T row = column[static_cast<std::size_t>(rows.begin) + i];
        change(row);
        column[first + i] = row;
    }
}

}  // namespace skerry
