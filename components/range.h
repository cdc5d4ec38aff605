// Rows that follow each other.
#pragma once

#include <algorithm>
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
