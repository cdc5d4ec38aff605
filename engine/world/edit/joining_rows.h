// Removal and renumbering of table rows that join bodies, such as joints (Model::for_each_joining).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "components/any_table.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Removes the marked rows of a table and their handles. `gone`: true for each row to be removed.
template <class Table, class Handle>
void erase_joining_rows(const std::vector<bool>& gone, Table& table, HandleMap<Handle>& map) {
    std::vector<Index> row_now;
    std::vector<Range> ranges;
    Index next = 0;
    for (std::size_t row = 0; row < gone.size(); ++row) {
        const auto index = static_cast<Index>(row);
        row_now.push_back(gone[row] ? no_index : next++);
        if (!gone[row]) continue;
        append_gone(Range{index, index + 1}, ranges);
        map.forget(map.handle_of_slot(table.slot[row]));
        if constexpr (requires { table.erase_keys_of(row); }) table.erase_keys_of(row);
    }
    if (ranges.empty()) return;
    AnyTable(table).erase(ranges);
    map.rows_moved(row_now);
}

/// Removes all rows that join the given body to others, for example its joints. Must be called before the body is
/// removed. Wakes all bodies of the removed rows.
void erase_rows_joining(std::size_t body, Model& model);

/// True if a row of a table with several bodies in each row, such as a joint, joins the body to another body or to the
/// world.
bool has_rows_joining(std::size_t body, Model& model);

/// Hands rows that act on one body only, such as loads, over from the body `before` to the body `after` with the same
/// mesh.
void hand_over_rows(std::size_t before, std::size_t after, Model& model);

/// Renumbers the bodies in joining rows after other bodies were removed. `body_now`: new row of each body, by its old
/// row in BodyTable.
void renumber_joining_rows(std::span<const Index> body_now, Model& model);

}  // namespace skerry
