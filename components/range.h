// Ranges of consecutive rows.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "components/types.h"

namespace skerry {

/// The rows begin .. end - 1 of a table.
struct Range {
    Index begin = 0;
    Index end = 0;

    Index size() const { return end - begin; }
    bool operator==(const Range&) const = default;
};

/// Returns the part of the span `all` that consists of the rows in `rows`.
template <class T>
std::span<T> rows_of(std::span<T> all, Range rows) {
    return all.subspan(static_cast<std::size_t>(rows.begin), static_cast<std::size_t>(rows.size()));
}
/// Returns the part of a column that consists of the rows in `rows`.
auto rows_of(auto& column, Range rows) requires requires {
    column.span();
}
{ return rows_of(column.span(), rows); }

/// New index of `row` after the ascending ranges `erased` have been removed. If `row` itself is removed, this is the
/// new index of the next remaining row.
inline Index row_without(Index row, std::span<const Range> erased) {
    Index below = 0;
    for (const Range& rows : erased) {
        if (rows.begin >= row) break;
        below += std::min(rows.end, row) - rows.begin;
    }
    return row - below;
}

/// Appends the range `rows` to the ascending list `erased` of removed ranges. If `rows` begins where the last listed
/// range ends, the two are merged into one range. `rows` must come after all listed rows.
void append_gone(Range rows, auto& erased) {
    if (rows.size() == 0) return;
    if (!erased.empty() && erased.back().end == rows.begin)
        erased.back().end = rows.end;
    else
        erased.push_back(rows);
}

}  // namespace skerry
