// Removal and renumbering of table rows that join bodies (Model::for_each_joining).
#pragma once

#include <cstddef>
#include <span>

#include "components/any_table.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Removes one row of a table and the handle of this row.
template <class Table, class Handle>
void erase_joining_row(std::size_t row, Table& table, HandleMap<Handle>& map) {
    map.forget(map.handle_of_slot(table.slot[row]));
    std::vector<Index> row_now;
    for (std::size_t r = 0; r < table.slot.size(); ++r)
        row_now.push_back(r == row ? no_index : static_cast<Index>(r < row ? r : r - 1));
    const Range gone{static_cast<Index>(row), static_cast<Index>(row) + 1};
    AnyTable(table).erase({&gone, 1});
    map.rows_moved(row_now);
}

/// Removes all rows that join a body, before this body is removed. Wakes all bodies of these rows.
void erase_rows_joining(std::size_t body, Model& model);

/// Renumbers the joined bodies after other bodies were removed. `body_now`: new row for each old row of BodyTable.
void renumber_joining_rows(std::span<const Index> body_now, Model& model);

}  // namespace skerry
