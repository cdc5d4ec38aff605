// Removal and renumbering of table rows that join bodies, such as joints (Model::for_each_joining).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "components/any_table.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Returns the range of the entries of a column that belong to one row. A column has either one entry for each row, or
/// a list of entries for each row (Table::list_of).
template <class Table>
Range entries_of(const Table& table, const ColumnInfo& column, std::size_t row) {
    if constexpr (requires { table.list_of(row); })
        if (!column.has_row_each) return table.list_of(row);
    return {static_cast<Index>(row), static_cast<Index>(row) + 1};
}

/// Columns that store a list of entries for each row of a table. `rows`: column with the range of the entries of each
/// row. `columns`: columns that contain the entries of all rows, one row after the other.
struct RowLists {
    Column<Range>* rows;
    std::vector<AnyColumn> columns;
};
inline std::vector<RowLists> lists_of(JointTable& t) {
    return {{&t.motor_keys, {t.key}}};
}
inline std::vector<RowLists> lists_of(SurfaceSetTable& t) {
    return {{&t.members, {t.member}}};
}
inline std::vector<RowLists> lists_of(TieTable& t) {
    return {{&t.nodes, {t.node, t.corner, t.weight, t.place, t.normal, t.impulse, t.broken}}};
}
inline std::vector<RowLists> lists_of(CableTable& t) {
    return {{&t.points, {t.anchor.body, t.anchor.collider, t.anchor.point, t.tension, t.length}}, {&t.keys, {t.key}}};
}
inline std::vector<RowLists> lists_of(CavityTable& t) {
    return {{&t.faces, {t.face, t.corners}}, {&t.keys, {t.key}}};
}
inline std::vector<RowLists> lists_of(PipeTable& t) {
    return {{&t.keys, {t.key}}};
}
inline std::vector<RowLists> lists_of(FibreTable& t) {
    return {{&t.tetrahedra, {t.tetrahedron, t.node, t.slope, t.volume, t.passive, t.mobility, t.next}},
            {&t.tension_keys, {t.key}}};
}
inline std::vector<RowLists> lists_of(LoadTable& t) {
    return {{&t.nodes, {t.node, t.weight}}, {&t.faces, {t.face}}, {&t.scale_keys, {t.key}}};
}
inline std::vector<RowLists> lists_of(SpringTable& t) {
    return {{&t.rest_length, {t.key}}};
}
inline std::vector<RowLists> lists_of(AttachmentTable& t) {
    return {{&t.nodes, {t.node, t.anchor}}};
}

/// Removes rows of a table and their handles. `removed`: true for each row to be removed.
template <class Table, class Handle>
void erase_joining_rows(const std::vector<bool>& removed, Table& table, NamedHandles<Handle>& map) {
    std::vector<Index> row_now;
    std::vector<Range> ranges;
    Index next = 0;
    for (std::size_t row = 0; row < removed.size(); ++row) {
        const auto index = static_cast<Index>(row);
        row_now.push_back(removed[row] ? no_index : next++);
        if (!removed[row]) continue;
        append_gone(Range{index, index + 1}, ranges);
        const Handle handle = map.handle_of_slot(table.slot[row]);
        map.names.erase(handle);
        map.forget(handle);
        if constexpr (requires { table.erase_keys_of(row); }) table.erase_keys_of(row);
        if constexpr (requires { table.erase_members_of(row); }) table.erase_members_of(row);
    }
    if (ranges.empty()) return;
    AnyTable(table).erase(ranges);
    if constexpr (requires { table.rows_moved(row_now); }) table.rows_moved(row_now);
    map.rows_moved(row_now);
}

/// Calls visit(row, joined) for each body or collider that a row of a joining table names. `role`: `body` or
/// `collider`. `joined` is a reference to the entry of the column, which is a row of BodyTable or ColliderTable. The
/// entry no_index means the world and is not visited.
template <class Table>
void for_each_joined(Table& table, ColumnRole role, auto&& visit) {
    const AnyTable any(table);
    for (const ColumnInfo& info : any.columns()) {
        if (info.role != role) continue;
        auto* const joined = reinterpret_cast<Index*>(any.column(info).write());
        for (std::size_t row = 0; row < table.slot.size(); ++row) {
            const Range entries = entries_of(table, info, row);
            for (Index entry = entries.begin; entry < entries.end; ++entry)
                if (joined[entry] != no_index) visit(row, joined[entry]);
        }
    }
}

/// Like erase_joining_rows(), but first wakes the bodies that the removed rows name.
template <class Table, class Handle>
void wake_and_erase_rows(const std::vector<bool>& removed, Table& table, NamedHandles<Handle>& map, Model& model) {
    for_each_joined(table, ColumnRole::body, [&](std::size_t row, Index body) {
        if (removed[row]) model.wake(static_cast<std::size_t>(body));
    });
    erase_joining_rows(removed, table, map);
}

/// Removes all rows that name an object, for example the joints and loads of a body. Must be called before the object
/// is removed. Wakes all bodies of the removed rows. `role`: `body` or `collider`; `object`: row of BodyTable or
/// ColliderTable.
void erase_rows_joining(ColumnRole role, Index object, Model& model);

/// Names of the tables whose rows can join several bodies, such as "joints". `body`: only tables in which a row names
/// this body are returned; no_index: all tables.
std::vector<const char*> tables_joining(Index body, Model& model);

/// Moves rows that act on one body only, such as loads, from the body `before` to the body `after` with the same mesh.
void hand_over_rows(std::size_t before, std::size_t after, Model& model);

/// Renumbers the bodies or colliders that joining rows name, after the removal of some bodies or colliders. `role`:
/// `body` or `collider`; `row_now`: new row of each object, by its old row in BodyTable or ColliderTable.
void renumber_joining_rows(ColumnRole role, std::span<const Index> row_now, Model& model);

}  // namespace skerry
