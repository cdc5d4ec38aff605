// One row per mesh vertex.
#pragma once

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

/// Mesh vertices of all bodies, body after body. Plain data: no behaviour, no pointers.
struct NodeTable {
    Column<Vec3> position;  // position in the world frame [m]
    Column<Vec3> velocity;  // [m/s]
    // Velocity at the end of the step; predict_velocity writes it, solve_regions corrects it [m/s].
    Column<Vec3> velocity_next;
    // Velocity of the split impulse, which moves the position in this step only [m/s]. Zero unless a contact with
    // overlap pushes the node.
    Column<Vec3> push_out;
    // Elastic and external force, only on nodes without degrees of freedom; written by predict_velocity [N].
    Column<Vec3> force;
    Column<Vec3> load;  // external force set by the user, valid until changed [N]
    // Sum of all force elements in this step, loads included; unused if there are none [N].
    Column<Vec3> applied_force;
    Column<Vec3> applied_before;       // applied_force of the last committed step, for the balance of energy [N]
    Column<Vec3> rest_position;        // position when the body was added, in the frame of the mesh [m]
    Column<Vec3> displacement_origin;  // position when BodyTable::displacement was last zero [m]
    Column<Vec3> still_position;       // position when BodyTable::drift was last zero [m]
    Column<Real> mass;                 // lumped [kg]
    Column<Real> inverse_mass;         // inverse mass; 0 for a pinned or kinematic node [1/kg]
    Column<Index> body;                // row of BodyTable

    /// Visits all columns. This is the only list of them: resize, erase, hash and save use it. Model::derive_all
    /// derives velocity_next and push_out, which are zero for nodes of sleeping bodies.
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
