// Sorting rows by a number: one pass to count, one to fill.
#pragma once

#include <cstddef>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Sorts rows by a number of theirs from 0 to `end` - 1; those of one number stay in their order. Rows by several
/// numbers: by the last of them first.
template <class Row>
void counting_sort(std::vector<Row>& rows, Index end, auto&& number_of) {
    std::vector<std::size_t> place(static_cast<std::size_t>(end) + 1, 0);
    for (const Row& row : rows) ++place[static_cast<std::size_t>(number_of(row)) + 1];
    for (std::size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
    std::vector<Row> sorted(rows.size());
    for (const Row& row : rows) sorted[place[static_cast<std::size_t>(number_of(row))]++] = row;
    rows.swap(sorted);
}

}  // namespace skerry
