// Rows that follow each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "components/types.h"

namespace skerry {

/// Rows begin .. end - 1 of some table.
struct Range {
    Index begin = 0;
    Index end = 0;

    Index size() const { return end - begin; }
    bool operator==(const Range&) const = default;
};

/// A range of rows, to be written or not as all of them are.
template <class T>
std::span<T> rows_of(std::span<T> all, Range rows) {
    return all.subspan(static_cast<std::size_t>(rows.begin), static_cast<std::size_t>(rows.size()));
}
/// The same of a column.
auto rows_of(auto& column, Range rows) requires requires {
    column.span();
}
{ return rows_of(column.span(), rows); }

/// Where a row is once ranges of rows, ascending, are gone; of one that is gone itself, where the next one is.
inline Index row_without(Index row, std::span<const Range> gone) {
    Index below = 0;
    for (const Range& rows : gone) {
        if (rows.begin >= row) break;
        below += std::min(rows.end, row) - rows.begin;
    }
    return row - below;
}

/// More rows that are gone, behind those that are listed.
void append_gone(Range rows, auto& gone) {
    if (rows.size() == 0) return;
    if (!gone.empty() && gone.back().end == rows.begin)
        gone.back().end = rows.end;
    else
        gone.push_back(rows);
}

}  // namespace skerry
