// One row per mesh vertex.
#pragma once

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

/// Mesh vertices of all bodies, body after body. Plain data: no behaviour, no pointers.
struct NodeTable {
    Column<Vec3> position;       // in the world frame [m]
    Column<Vec3> velocity;       // [m/s]
    Column<Vec3> velocity_next;  // written by predict_velocity, corrected by solve_regions [m/s]
    // Split impulse: moves the position in this step only; zero unless a contact is pressed in [m/s].
    Column<Vec3> push_out;
    Column<Vec3> force;  // elastic and external, on nodes without degrees of freedom; written by predict_velocity [N]
    Column<Vec3> load;   // set by the user, kept until changed [N]
    Column<Vec3> applied_force;        // sum of all force elements in this step, loads included; unused without any [N]
    Column<Vec3> applied_before;       // applied_force of the last committed step, for the balance of energy [N]
    Column<Vec3> rest_position;        // as added, in the frame of the mesh [m]
    Column<Vec3> displacement_origin;  // position when the displacement of its body was last zero [m]
    Column<Vec3> still_position;       // position when the drift of its body was last zero [m]
    Column<Real> mass;                 // lumped [kg]
    Column<Real> inverse_mass;         // 0: pinned or kinematic [1/kg]
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
        visit("applied_force", applied_force, ColumnRole::scratch);
        visit("applied_before", applied_before, ColumnRole::memory);
        visit("displacement_origin", displacement_origin, ColumnRole::memory);
    }
};

}  // namespace skerry
