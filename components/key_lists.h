// Lists of keys, which describe values that change over time.
#pragma once

#include <cstddef>
#include <span>

#include "components/column.h"
#include "components/range.h"
#include "components/row_type.h"
#include "components/time_key.h"
#include "components/types.h"

namespace skerry {

template <>
struct NumbersOf<TimeKey> : Reals<2> {};

/// Value of a list of keys at the time `t`: linear between keys, constant before the first key and after the last.
/// `keys`: at least one key, with ascending times.
Real value_at(std::span<const TimeKey> keys, Real t);
/// Exact mean of the value over the time from `t` to `t + h`, with h > 0.
Real mean_value(std::span<const TimeKey> keys, Real t, Real h);
/// Returns whether the value changes at any time from `t` to `t + h`.
bool changes(std::span<const TimeKey> keys, Real t, Real h);

// Some tables have a list of keys in each row. Such a table has the column `key` with the keys of all lists, and a
// column with the range of each list in `key`.

/// Erases the list of one row from columns that contain the lists of all rows. `range`: range of the list of each row.
template <class... T>
void erase_lists(Column<Range>& range, std::size_t row, Column<T>&... lists) {
    const Range erased = range[row];
    (lists.erase(static_cast<std::size_t>(erased.begin), static_cast<std::size_t>(erased.size())), ...);
    range[row] = {};
    for (Range& other : range)
        if (other.begin > erased.begin) other = {other.begin - erased.size(), other.end - erased.size()};
}

/// Erases the list of keys of row `row`. `range`: range in `key` of the list of each row.
inline void erase_keys(Column<Range>& range, Column<TimeKey>& key, std::size_t row) {
    erase_lists(range, row, key);
}
/// Replaces the list of keys of row `row`. `range`: range in `key` of the list of each row.
void set_keys(Column<Range>& range, Column<TimeKey>& key, std::size_t row, std::span<const TimeKey> keys);

}  // namespace skerry
