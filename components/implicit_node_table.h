// One row per node of the implicit bodies, body after body, in node order. A row holds the deformation in the frame of
// the mesh, which moves like a rigid body (docs/methods/implicit_bodies.md 1).
#pragma once

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

struct ImplicitNodeTable {
    Column<Vec3> displacement;  // u [m]
    Column<Vec3> velocity;      // deformation velocity w; for a held body the whole velocity [m/s]
    // Velocity that contacts added to w in the last long step, times the length of that step [m]. It is zero outside a
    // long step. Written by carry_long_steps.
    Column<Vec3> left;
    // kick_implicit_bodies writes the next columns in this step:
    Column<Vec3> elastic_force;  // elastic force K u, in the order of the factorised matrix [N]
    Column<Vec3> impulse;        // impulse in the same order; the solution overwrites it [N s]
    // Velocity w at the end of the step: first without contacts, until strain_implicit_bodies adds their effect.
    Column<Vec3> velocity_next;
    // solve_regions adds to this column, starting from zero:
    Column<Vec3> contact_impulse;  // impulse of contacts, in the world frame [N s]
    // Written by strain_implicit_bodies:
    Column<Vec3> displacement_next;
    Column<Vec3> force_rate;  // rate of the elastic force K w, in the order of the factorised matrix [N/s]

    std::size_t size() const { return displacement.size(); }

    /// Visits all columns. This is the only list of them.
    void for_each_column(auto&& visit) {
        visit("displacement", displacement, ColumnRole::state);
        visit("velocity", velocity, ColumnRole::state);
        visit("left", left, ColumnRole::link);  // hashed only if it is not zero
        visit("elastic_force", elastic_force, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("velocity_next", velocity_next, ColumnRole::scratch);
        visit("contact_impulse", contact_impulse, ColumnRole::scratch);
        visit("displacement_next", displacement_next, ColumnRole::scratch);
        visit("force_rate", force_rate, ColumnRole::scratch);
    }
};

}  // namespace skerry
