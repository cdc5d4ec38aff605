// One row per mesh vertex.
#pragma once

#include "components/column.h"
#include "components/step_levels.h"
#include "components/types.h"

namespace skerry {

/// Mesh vertices of all bodies, body after body. Plain data: no behaviour, no pointers.
struct NodeTable {
    Column<Vec3> position;       // m, world frame
    Column<Vec3> velocity;       // m/s
    Column<Vec3> velocity_next;  // m/s, written by predict_velocity, corrected by solve_regions
    Column<Vec3> push_out;       // m/s, split impulse: moves the position of this step only; zero unless a contact is pressed in
    Column<Vec3> force;          // N, elastic and external, on nodes without freedom; written by predict_velocity
    Column<Vec3> load;           // N, set by the user, kept until changed
    Column<Vec3> rest_position;  // m, as added, in the frame of the mesh
    Column<Vec3> drift_origin;   // m, where the node was when the drift of its body was last zero
    Column<Real> mass;           // kg, lumped
    Column<Real> inverse_mass;   // 1/kg, 0: pinned or kinematic
    Column<Index> body;          // row of BodyTable
    Column<LevelMask> levels;    // levels, within their body, of the elements around the node

    /// What the next step depends on: hash and snapshot walk this part.
    void for_each_state_column(auto&& visit) {
        visit("position", position);
        visit("velocity", velocity);
        visit("load", load);
        visit("rest_position", rest_position);
        visit("mass", mass);
        visit("inverse_mass", inverse_mass);
        visit("body", body);
    }
    /// The only list of columns: resize and erase walk it.
    void for_each_column(auto&& visit) {
        for_each_state_column(visit);
        visit("velocity_next", velocity_next);
        visit("push_out", push_out);
        visit("force", force);
        visit("drift_origin", drift_origin);
        visit("levels", levels);
    }
};

}  // namespace skerry
