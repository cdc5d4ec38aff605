// Counting sort: the first pass counts how often each key occurs, the second pass moves the rows.
#pragma once

#include <cstddef>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Stable sort of rows by the integer key number_of(row), which lies between 0 and `end` - 1. To sort by several keys,
/// sort by the least significant key first. `spare` is working memory. Several sorts should share it, because accessing
/// newly allocated pages costs as much as a sort.
template <class Row>
void counting_sort(std::vector<Row>& rows, std::vector<Row>& spare, Index end, auto&& number_of) {
    std::vector<std::size_t> place(static_cast<std::size_t>(end) + 1, 0);
    for (const Row& row : rows) ++place[static_cast<std::size_t>(number_of(row)) + 1];
    for (std::size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
    spare.resize(rows.size());
    for (const Row& row : rows) spare[place[static_cast<std::size_t>(number_of(row))]++] = row;
    rows.swap(spare);
}
template <class Row>
void counting_sort(std::vector<Row>& rows, Index end, auto&& number_of) {
    std::vector<Row> spare;
    counting_sort(rows, spare, end, number_of);
}

}  // namespace skerry
