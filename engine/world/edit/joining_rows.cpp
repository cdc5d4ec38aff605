#include "engine/world/edit/joining_rows.h"

#include <vector>

namespace skerry {

namespace {

/// True if a row of a table can name several bodies: in several columns, or in a list.
bool joins_bodies(AnyTable table) {
    std::size_t count = 0;
    for (const ColumnInfo& info : table.columns())
        if (info.role == ColumnRole::body) count += info.has_row_each ? 1 : 2;
    return count > 1;
}

}  // namespace

void erase_rows_joining(ColumnRole role, Index object, Model& model) {
    model.for_each_joining([&](const char*, auto& table, auto& map) {
        std::vector<bool> removed(table.slot.size(), false);
        for_each_joined(table, role, [&](std::size_t row, Index joined) {
            if (joined == object) removed[row] = true;
        });
        wake_and_erase_rows(removed, table, map, model);
    });
}

std::vector<const char*> tables_joining(Index body, Model& model) {
    std::vector<const char*> names;
    model.for_each_joining([&](const char* name, auto& table, auto&) {
        if (!joins_bodies(table)) return;
        bool found = body == no_index;
        for_each_joined(table, ColumnRole::body, [&](std::size_t, Index joined) { found |= joined == body; });
        if (found) names.push_back(name);
    });
    return names;
}

void hand_over_rows(std::size_t before, std::size_t after, Model& model) {
    model.for_each_joining([&](const char*, auto& table, auto&) {
        if (joins_bodies(table)) return;
        for_each_joined(table, ColumnRole::body, [&](std::size_t, Index& body) {
            if (body == static_cast<Index>(before)) body = static_cast<Index>(after);
        });
    });
}

void renumber_joining_rows(ColumnRole role, std::span<const Index> row_now, Model& model) {
    model.for_each_joining([&](const char*, auto& table, auto&) {
        for_each_joined(table, role,
                        [&](std::size_t, Index& joined) { joined = row_now[static_cast<std::size_t>(joined)]; });
    });
}

}  // namespace skerry
