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
    // Velocity at the end of the step; predict_velocity writes it, and solve_regions corrects it [m/s].
    Column<Vec3> velocity_next;
    // Velocity that separates overlapping surfaces: it moves the position in this step, but does not become part of
    // `velocity` [m/s]. It is zero unless a contact with overlap acts on the node.
    Column<Vec3> push_out;
    // Elastic and external force on a node without degrees of freedom, from which reactions are measured; not computed
    // for other nodes. predict_velocity writes it [N].
    Column<Vec3> force;
    Column<Vec3> load;  // external force set by the user, which acts until the user changes it [N]
    // Sum of the forces of all force elements in this step, including `load`; unused if the world has no force element
    // [N].
    Column<Vec3> applied_force;
    Column<Vec3> applied_before;       // applied_force of the last committed step, used in the energy balance [N]
    Column<Vec3> rest_position;        // position when the body was added, in the frame of the mesh [m]
    Column<Vec3> displacement_origin;  // position when BodyTable::displacement was last zero [m]
    Column<Vec3> still_position;       // position when BodyTable::drift was last zero [m]
    Column<Real> mass;                 // lumped mass [kg]
    Column<Real> inverse_mass;         // inverse mass; 0 for a pinned or kinematic node [1/kg]
    Column<Index> body;                // row of BodyTable

    /// Visits all columns. This is the only list of the columns; resizing, erasing, hashing and saving use it.
    /// Model::derive_all derives velocity_next and push_out, which are zero for nodes of sleeping bodies.
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
