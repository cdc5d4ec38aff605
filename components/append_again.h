// Appends copies of the rows of a body for another body with the same mesh.
#pragma once

#include <array>
#include <cstddef>

#include "components/column.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Rows of a body minus the corresponding rows of an earlier body with the same mesh.
struct RowsBehind {
    Index nodes, elements;  // `nodes`: rows of NodeTable; `elements`: numbers of tetrahedra in TetrahedronBlockTable
    Index triangles = 0, edges = 0, vertices = 0;
};

/// Adds `by` to a row index; the value no_index is not changed.
inline void move_on(Index& row, Index by) {
    if (row != no_index) row += by;
}
template <std::size_t count>
void move_on(std::array<Index, count>& rows, Index by) {
    for (Index& row : rows) move_on(row, by);
}

/// Appends copies of the rows in the range `rows` to the column. change(row) is applied to each copy before the copy is
/// stored.
template <class T>
void append_again(Column<T>& column, Range rows, auto&& change) {
    const std::size_t first = column.size(), count = static_cast<std::size_t>(rows.size());
    column.resize(first + count);
    for (std::size_t i = 0; i < count; ++i) {
        T row = column[static_cast<std::size_t>(rows.begin) + i];
        change(row);
        column[first + i] = row;
    }
}

}  // namespace skerry
