// Ranges of consecutive rows.
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

/// Returns the part of `all` that covers `rows`.
template <class T>
std::span<T> rows_of(std::span<T> all, Range rows) {
    return all.subspan(static_cast<std::size_t>(rows.begin), static_cast<std::size_t>(rows.size()));
}
/// Returns the part of a column that covers `rows`.
auto rows_of(auto& column, Range rows) requires requires {
    column.span();
}
{ return rows_of(column.span(), rows); }

/// New index of a row after the ascending ranges `gone` are removed. For a removed row: new index of the next remaining
/// row.
inline Index row_without(Index row, std::span<const Range> gone) {
    Index below = 0;
    for (const Range& rows : gone) {
        if (rows.begin >= row) break;
        below += std::min(rows.end, row) - rows.begin;
    }
    return row - below;
}

/// Appends `rows` to the ascending list `gone` of removed ranges, and merges them with the last range if the two are
/// adjacent. `rows` must follow all listed rows.
void append_gone(Range rows, auto& gone) {
    if (rows.size() == 0) return;
    if (!gone.empty() && gone.back().end == rows.begin)
        gone.back().end = rows.end;
    else
        gone.push_back(rows);
}

}  // namespace skerry
