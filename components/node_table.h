// One row per mesh vertex.
#pragma once

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

/// Mesh vertices of all bodies, body after body. Plain data: no behaviour, no pointers.
struct NodeTable {
    Column<Vec3> position;       // m, world frame
    Column<Vec3> velocity;       // m/s
    Column<Vec3> velocity_next;  // m/s, written by predict_velocity, corrected by solve_regions
    // m/s, split impulse: moves the position of this step only; zero unless a contact is pressed in
    Column<Vec3> push_out;
    Column<Vec3> force;                // N, elastic and external, on nodes without freedom; written by predict_velocity
    Column<Vec3> load;                 // N, set by the user, kept until changed
    Column<Vec3> rest_position;        // m, as added, in the frame of the mesh
    Column<Vec3> displacement_origin;  // m, where the node was when the displacement of its body was last zero
    Column<Vec3> still_position;       // m, where the node was when the drift of its body was last zero
    Column<Real> mass;                 // kg, lumped
    Column<Real> inverse_mass;         // 1/kg, 0: pinned or kinematic
    Column<Index> body;                // row of BodyTable

    /// The only list of columns: resize, erase, hash and save walk it. Derived: velocity_next (zero at rest) and
    /// push_out by Model::derive_all.
    void for_each_column(auto&& visit) {
        visit("position", position, ColumnRole::state);
        visit("velocity", velocity, ColumnRole::state);
        visit("load", load, ColumnRole::state);
        visit("rest_position", rest_position, ColumnRole::state);
        visit("still_position", still_position, ColumnRole::state);
        visit("mass", mass, ColumnRole::state);
        visit("inverse_mass", inverse_mass, ColumnRole::state);
        visit("body", body, ColumnRole::link);
        visit("velocity_next", velocity_next, ColumnRole::derived);
        visit("push_out", push_out, ColumnRole::derived);
        visit("force", force, ColumnRole::scratch);
        visit("displacement_origin", displacement_origin, ColumnRole::memory);
    }
};

}  // namespace skerry
