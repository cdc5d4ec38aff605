// A point that is fixed to the material of a body, to a collider, or to the world.
#pragma once

#include <array>
#include <span>

#include "components/column.h"
#include "components/column_role.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// A point in the coordinates of the object to which it is fixed.
struct AnchorRow {
    // On a body: the point is the weighted mean of four nodes. The weights sum to 1. Nodes are numbered as in the mesh.
    std::array<Index, 4> node{};
    std::array<Real, 4> weight{};
    // On a collider: position in the frame of the collider. Without body and collider: position in the world [m].
    Vec3 point = Vec3::Zero();

    bool operator==(const AnchorRow&) const = default;
};
template <>
struct MembersOf<AnchorRow> {
    static std::span<const Member> list();
};

/// Columns of a table in which each row has an anchor, for example a table of the points of cables. An anchor without
/// body and collider is fixed to the world.
struct AnchorColumns {
    Column<Index> body;      // row of BodyTable, or no_index
    Column<Index> collider;  // row of ColliderTable, or no_index; always no_index if there is a body
    Column<AnchorRow> point;

    /// Names of the three columns.
    struct Names {
        const char *body, *collider, *point;
    };
    void for_each_column(const Names& name, auto&& visit) {
        visit(name.body, body, ColumnRole::body);
        visit(name.collider, collider, ColumnRole::collider);
        visit(name.point, point, ColumnRole::state);
    }
};

}  // namespace skerry
