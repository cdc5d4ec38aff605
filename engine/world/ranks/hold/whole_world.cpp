#include "engine/world/ranks/hold/whole_world.h"

#include "components/union_find.h"
#include "engine/world/edit/joining_rows.h"

namespace skerry {

namespace {

/// For each handle slot: row of the table, or no_index. `slot`: slot of each row.
std::vector<Index> rows_by_slot(std::span<const std::uint32_t> slot) {
    std::vector<Index> rows;
    for (std::size_t row = 0; row < slot.size(); ++row) {
        if (slot[row] == no_slot) continue;
        if (rows.size() <= slot[row]) rows.resize(slot[row] + 1, no_index);
        rows[slot[row]] = static_cast<Index>(row);
    }
    return rows;
}

/// Returns for each body the row of the first body of its unit. A unit is a set of bodies that joints, ties, cables,
/// springs and other rows connect (WholeWorld::unit).
Column<Index> units_of(Model& model) {
    UnionFind bodies;
    bodies.start(model.bodies.slot.size());
    model.for_each_joining([&](const char*, auto& table, auto&) {
        std::vector<Index> first(table.slot.size(), no_index);
        for_each_joined(table, ColumnRole::body, [&](std::size_t row, Index body) {
            if (first[row] == no_index)
                first[row] = body;
            else
                bodies.join(first[row], body);
        });
        if constexpr (requires { table.leader; })
            for (std::size_t row = 0; row < first.size(); ++row)
                if (table.leader[row] != no_index) bodies.join(first[row], first[table.leader[row]]);
    });
    Column<Index> units;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) units.push_back(bodies.root(static_cast<Index>(b)));
    return units;
}

}  // namespace

WholeWorld whole_world_of(Model& model) {
    WholeWorld whole;
    const BodyTable& bodies = model.bodies;
    whole.slot = bodies.slot;
    whole.unit = units_of(model);
    whole.records.resize(bodies.slot.size());
    Column<std::uint32_t> own = bodies.slot;
    for (std::size_t b = 0; b < own.size(); ++b) {
        const bool moves = bodies.kind[b] == BodyKind::deformable;
        if (!moves) own[b] = no_slot;  // a kinematic body has no handle slot of its own, but that of its collider
        whole.owner.push_back(moves ? 0 : WholeWorld::everywhere);
    }
    whole.world_row_of_slot = rows_by_slot(own);
    model.for_each_joining(
        [&](const char*, auto& table, auto&) { whole.joining_world_row.push_back(rows_by_slot(table.slot)); });
    whole.joining_world_row.push_back(rows_by_slot(model.attachments.slot));
    return whole;
}

}  // namespace skerry
