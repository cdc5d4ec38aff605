// Counting sort: the first pass counts how often each key occurs, the second pass moves the rows.
#pragma once

#include <cstddef>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Stable sort of rows by the integer key number_of(row), which lies between 0 and `end` - 1. To sort by several keys,
/// sort by the least significant key first. `buffer` is working memory. Several sorts should share `buffer`, because
/// the first access to newly allocated memory takes as long as a sort.
template <class Row>
void counting_sort(std::vector<Row>& rows, std::vector<Row>& buffer, Index end, auto&& number_of) {
    std::vector<std::size_t> next(static_cast<std::size_t>(end) + 1, 0);
    for (const Row& row : rows) ++next[static_cast<std::size_t>(number_of(row)) + 1];
    for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
    buffer.resize(rows.size());
    for (const Row& row : rows) buffer[next[static_cast<std::size_t>(number_of(row))]++] = row;
    rows.swap(buffer);
}
template <class Row>
void counting_sort(std::vector<Row>& rows, Index end, auto&& number_of) {
    std::vector<Row> buffer;
    counting_sort(rows, buffer, end, number_of);
}

}  // namespace skerry
