// Deformation of the implicit bodies, one row per node: body after body, in node order. It is measured in the frame of
// the mesh, which moves like a rigid body (docs/methods/implicit_bodies.md 1).
#pragma once

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

struct ImplicitNodeTable {
    Column<Vec3> displacement;  // displacement u by the deformation, in the frame of the mesh [m]
    // deformation velocity w; for a body held by an attachment: world velocity in the axes of the frame [m/s]
    Column<Vec3> velocity;
    // Effect of the contacts of the previous long step, which is a step of the body that covers several steps of the
    // world: their change of the velocity w, times the length of that long step [m]. The present long step first
    // assumes that these contacts act again, and gradually replaces them by its own (docs/methods/implicit_bodies.md
    // 9).
    //
    // Zero for bodies without long steps. carry_long_steps writes the column.
    Column<Vec3> left;
    // kick_implicit_bodies writes the next three columns in this step.
    Column<Vec3> elastic_force;
    // impulse on the nodes in the order of the factorised matrix [N s]; the solve overwrites it with the velocities w
    // [m/s]
    Column<Vec3> impulse;
    // Velocity w at the end of the step. kick_implicit_bodies writes it without the effect of contacts;
    // strain_implicit_bodies adds this effect.
    Column<Vec3> velocity_next;
    // solve_regions adds the impulses of contacts to the next column, which is zero when the step begins.
    Column<Vec3> contact_impulse;  // sum of the contact impulses on the node, in the world frame [N s]
    // strain_implicit_bodies writes the next two columns.
    Column<Vec3> displacement_next;
    // rate of change K w of the elastic force, with the stiffness matrix K; nodes in the order of the factorised matrix
    // [N/s]
    Column<Vec3> force_rate;

    std::size_t size() const { return displacement.size(); }

    /// Visits all columns. This is the only list of the columns.
    void for_each_column(auto&& visit) {
        visit("displacement", displacement, ColumnRole::state);
        visit("velocity", velocity, ColumnRole::state);
        visit("left", left, ColumnRole::link);  // hashed only if the vector is not zero
        visit("elastic_force", elastic_force, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("velocity_next", velocity_next, ColumnRole::scratch);
        visit("contact_impulse", contact_impulse, ColumnRole::scratch);
        visit("displacement_next", displacement_next, ColumnRole::scratch);
        visit("force_rate", force_rate, ColumnRole::scratch);
    }
};

}  // namespace skerry
