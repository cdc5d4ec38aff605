// One row per attachment: nodes of one body held in space or moved by a script.
#pragma once

#include <cstdint>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

/// True if an attachment holds its nodes along all directions. `held`: columns are orthonormal directions or zero.
inline bool holds_completely(const Mat3& held) {
    return held.isIdentity(0);
}

struct AttachmentTable {
    Column<std::uint32_t> slot;
    Column<Index> body;   // row of BodyTable
    Column<Range> nodes;  // range of rows in the columns `node` and `anchor`
    // pose and motion in this step; when the step begins, a held node is at position + rotation * anchor
    Column<RigidMotion> motion;
    Column<RigidMotion> initial;  // pose and motion of the attachment at the start of the script
    Column<MotionScript> script;
    // Columns of the matrix: orthonormal directions along which the nodes are held; the other columns are zero. The
    // identity matrix marks nodes that are held completely; only such nodes have the inverse mass 0.
    Column<Mat3> held;
    Column<Index> node;         // held nodes of all attachments: rows of NodeTable
    Column<Vec3> anchor;        // position of `node` in the frame of the attachment [m]
    Column<Keyframe> keyframe;  // keyframes of all attachments; each script refers to a range of these rows

    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("body", body, ColumnRole::link);
        visit("nodes", nodes, ColumnRole::link);
        visit("motion", motion, ColumnRole::memory);
        visit("initial", initial, ColumnRole::state);
        visit("script", script, ColumnRole::link);
        visit("held", held, ColumnRole::state);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("node", node, ColumnRole::link);
        visit("anchor", anchor, ColumnRole::state);
        visit("keyframe", keyframe, ColumnRole::state);
    }
};

}  // namespace skerry
