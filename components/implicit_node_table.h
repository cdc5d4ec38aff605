// One row per node of the bodies that move implicitly, body after body, in the order of their nodes: how they deform in
// the frame of their mesh, which moves as a rigid body does (docs/methods/implicit_bodies.md 1).
#pragma once

#include "components/column.h"
#include "components/column_role.h"
#include "components/types.h"

namespace skerry {

struct ImplicitNodeTable {
    Column<Vec3> displacement;  // m, u
    Column<Vec3> velocity;      // m/s, w; of a held body the whole velocity
    // m, of what its contacts gave to the velocity of the displacement in the last long step, by its length; zero where
    // it is in none. By carry_long_steps
    Column<Vec3> left;
    // Of this step, by kick_implicit_bodies:
    Column<Vec3> elastic_force;  // N, K u, by place in the factor
    Column<Vec3> impulse;        // N s, by place; afterwards what is made of it
    // without contacts; with them, by strain_implicit_bodies
    Column<Vec3> velocity_next;
    // by solve_regions, from zero:
    Column<Vec3> contact_impulse;  // N s, world
    // by strain_implicit_bodies:
    Column<Vec3> displacement_next;
    Column<Vec3> force_rate;  // N/s, K w, by place

    std::size_t size() const { return displacement.size(); }

    /// The only list of columns.
    void for_each_column(auto&& visit) {
        visit("displacement", displacement, ColumnRole::state);
        visit("velocity", velocity, ColumnRole::state);
        visit("left", left, ColumnRole::link);  // hashed where it is not zero
        visit("elastic_force", elastic_force, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("velocity_next", velocity_next, ColumnRole::scratch);
        visit("contact_impulse", contact_impulse, ColumnRole::scratch);
        visit("displacement_next", displacement_next, ColumnRole::scratch);
        visit("force_rate", force_rate, ColumnRole::scratch);
    }
};

}  // namespace skerry
