#include "engine/world/edit/joining_rows.h"

#include <algorithm>
#include <vector>

namespace skerry {

namespace {

/// Calls visit(row, body) for each body that a row of a joining table names. `body` is a reference to the entry of the
/// column, which is a row of BodyTable. The entry no_index stands for the world and is not visited.
void for_each_joined_body(AnyTable table, auto&& visit) {
    for (const ColumnInfo& info : table.columns()) {
        if (info.role != ColumnRole::body) continue;
        const AnyColumn column = table.column(info);
        auto* const bodies = reinterpret_cast<Index*>(column.write());
        for (std::size_t row = 0; row < column.size(); ++row)
            if (bodies[row] != no_index) visit(row, bodies[row]);
    }
}

bool joins_bodies(AnyTable table) {
    return std::ranges::count(table.columns(), ColumnRole::body, &ColumnInfo::role) > 1;
}

}  // namespace

void erase_rows_joining(std::size_t body, Model& model) {
    model.for_each_joining([&](const char*, auto& table, auto& map) {
        std::vector<bool> gone(table.slot.size(), false);
        for_each_joined_body(table, [&](std::size_t row, Index joined) {
            if (joined == static_cast<Index>(body)) gone[row] = true;
        });
        for_each_joined_body(table, [&](std::size_t row, Index joined) {
            if (gone[row]) model.wake(static_cast<std::size_t>(joined));
        });
        erase_joining_rows(gone, table, map);
    });
}

bool has_rows_joining(std::size_t body, Model& model) {
    bool found = false;
    model.for_each_joining([&](const char*, auto& table, auto&) {
        if (!joins_bodies(table)) return;
        for_each_joined_body(table, [&](std::size_t, Index joined) { found |= joined == static_cast<Index>(body); });
    });
    return found;
}

void hand_over_rows(std::size_t before, std::size_t after, Model& model) {
    model.for_each_joining([&](const char*, auto& table, auto&) {
        if (joins_bodies(table)) return;
        for_each_joined_body(table, [&](std::size_t, Index& body) {
            if (body == static_cast<Index>(before)) body = static_cast<Index>(after);
        });
    });
}

void renumber_joining_rows(std::span<const Index> body_now, Model& model) {
    model.for_each_joining([&](const char*, auto& table, auto&) {
        for_each_joined_body(table, [&](std::size_t, Index& body) { body = body_now[static_cast<std::size_t>(body)]; });
    });
}

}  // namespace skerry
