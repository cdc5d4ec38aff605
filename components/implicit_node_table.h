// One row per node of the implicit bodies, body after body, in node order: the deformation in the frame of the mesh,
// which moves like a rigid body (docs/methods/implicit_bodies.md 1).
#pragma once

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

struct ImplicitNodeTable {
    Column<Vec3> displacement;  // u [m]
    Column<Vec3> velocity;      // w; for a held body the whole velocity [m/s]
    // Velocity that its contacts added to w in the last long step, times the length of that step [m]; zero outside a
    // long step. Written by carry_long_steps.
    Column<Vec3> left;
    // Written in this step by kick_implicit_bodies:
    Column<Vec3> elastic_force;  // K u, by place in the factor [N]
    Column<Vec3> impulse;        // by place; afterwards overwritten by the result [N s]
    // First without contacts; strain_implicit_bodies adds them.
    Column<Vec3> velocity_next;
    // Accumulated from zero by solve_regions:
    Column<Vec3> contact_impulse;  // in the world frame [N s]
    // Written by strain_implicit_bodies:
    Column<Vec3> displacement_next;
    Column<Vec3> force_rate;  // K w, by place [N/s]

    std::size_t size() const { return displacement.size(); }

    /// The only list of columns.
    void for_each_column(auto&& visit) {
        visit("displacement", displacement, ColumnRole::state);
        visit("velocity", velocity, ColumnRole::state);
        visit("left", left, ColumnRole::link);  // hashed if not zero
        visit("elastic_force", elastic_force, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("velocity_next", velocity_next, ColumnRole::scratch);
        visit("contact_impulse", contact_impulse, ColumnRole::scratch);
        visit("displacement_next", displacement_next, ColumnRole::scratch);
        visit("force_rate", force_rate, ColumnRole::scratch);
    }
};

}  // namespace skerry
