// One row per rigid body: how it moves as a whole. Its nodes follow (docs/methods/rigid_bodies.md).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/node_table.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// The principal frame has its origin in the centre of mass and its axes along those of inertia. `axes` turns it into
/// the frame of the mesh, `rotation` into the world: a node is at center + rotation axes^T (rest_position -
/// rest_center).
struct RigidBodyTable {
    Column<Index> body;  // row of BodyTable
    Column<Real> mass;   // kg
    // What deforms by much has those of its shape:
    Column<Vec3> moments;           // kg m^2, of inertia about the principal axes
    Column<Mat3> axes;              // of the principal frame, in the frame of the mesh
    Column<Vec3> rest_center;       // m, in the frame of the mesh
    Column<Vec3> center;            // m
    Column<Mat3> rotation;          // principal frame to world
    Column<Vec3> momentum;          // kg m/s
    Column<Vec3> angular_momentum;  // kg m^2/s, about the centre
    Column<std::uint8_t> large;     // whether what deforms in its frame does so by the laws of its elements
    // The attachment that holds it as a whole, or the frame of what deforms in it, and where the frame of the mesh is
    // in that of the attachment:
    Column<Index> holder;        // row of AttachmentTable, or no_index
    Column<Vec3> held_position;  // m
    Column<Mat3> held_rotation;
    // Of this step, by kick_rigid_bodies:
    Column<Mat3> inverse_inertia;    // 1/(kg m^2), world
    Column<Vec3> kick, moment_kick;  // N s, N m s about the centre: of gravity and loads
    // by solve_regions, from zero:
    Column<Vec3> contact_impulse, contact_moment;  // N s, N m s about the centre
    Column<Vec3> push_velocity, push_spin;         // m/s, rad/s: of this step's positions only
    // by turn_rigid_bodies:
    Column<Vec3> center_next;
    Column<Mat3> rotation_next;
    // by strain_implicit_bodies: how a body turns in the shape that it has come to, and its principal frame in the
    // world before it is turned. Of rigid bodies, and of those that are deformed by little, they stay
    Column<Vec3> moments_next;
    Column<Mat3> axes_next, rotation_shaped;
    // N m s, what keeps the frame of a held body on its way against what deforms in it
    Column<Vec3> hold_moment;
    Column<std::uint8_t> large_next;

    std::size_t size() const { return mass.size(); }

    /// The only list of columns. Derived: by find_holders. `large` is hashed where it is set.
    void for_each_column(auto&& visit) {
        visit("body", body, ColumnRole::link);
        visit("mass", mass, ColumnRole::state);
        visit("moments", moments, ColumnRole::state);
        visit("axes", axes, ColumnRole::state);
        visit("rest_center", rest_center, ColumnRole::state);
        visit("center", center, ColumnRole::state);
        visit("rotation", rotation, ColumnRole::state);
        visit("momentum", momentum, ColumnRole::state);
        visit("angular_momentum", angular_momentum, ColumnRole::state);
        visit("large", large, ColumnRole::link);
        visit("holder", holder, ColumnRole::derived);
        visit("held_position", held_position, ColumnRole::derived);
        visit("held_rotation", held_rotation, ColumnRole::derived);
        visit("inverse_inertia", inverse_inertia, ColumnRole::scratch);
        visit("kick", kick, ColumnRole::scratch);
        visit("moment_kick", moment_kick, ColumnRole::scratch);
        visit("contact_impulse", contact_impulse, ColumnRole::scratch);
        visit("contact_moment", contact_moment, ColumnRole::scratch);
        visit("push_velocity", push_velocity, ColumnRole::scratch);
        visit("push_spin", push_spin, ColumnRole::scratch);
        visit("center_next", center_next, ColumnRole::scratch);
        visit("rotation_next", rotation_next, ColumnRole::scratch);
        visit("moments_next", moments_next, ColumnRole::scratch);
        visit("axes_next", axes_next, ColumnRole::scratch);
        visit("rotation_shaped", rotation_shaped, ColumnRole::scratch);
        visit("hold_moment", hold_moment, ColumnRole::scratch);
        visit("large_next", large_next, ColumnRole::scratch);
    }
};

}  // namespace skerry
