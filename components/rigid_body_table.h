// One row per rigid or implicit body: its rigid motion, which its nodes follow (docs/methods/rigid_bodies.md).
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

/// One row per rigid or implicit body. The principal frame of a body has its origin in the centre of mass and its axes
/// along the principal axes of inertia. `axes` maps the principal frame to the frame of the mesh, `rotation` maps it to
/// the world. A node of a rigid body is at center + rotation axes^T (rest_position - rest_center).
struct RigidBodyTable {
    Column<Index> body;  // row of BodyTable
    Column<Real> mass;   // [kg]
    // Mass distribution of the rest shape, or of the current shape if the deformation is large:
    Column<Vec3> moments;           // moments of inertia about the principal axes [kg m^2]
    Column<Mat3> axes;              // axes of the principal frame, in the frame of the mesh
    Column<Vec3> rest_center;       // centre of mass, in the frame of the mesh [m]
    Column<Vec3> center;            // [m]
    Column<Mat3> rotation;          // maps the principal frame to the world
    Column<Vec3> momentum;          // [kg m/s]
    Column<Vec3> angular_momentum;  // angular momentum about the centre of mass [kg m^2/s]
    Column<std::uint8_t> large;     // 1: the deformation is large and follows the nonlinear laws of the elements
    // The attachment that holds a rigid body or the frame of an implicit body, and the pose of the frame of the mesh in
    // the frame of the attachment:
    Column<Index> holder;        // row of AttachmentTable, or no_index
    Column<Vec3> held_position;  // [m]
    Column<Mat3> held_rotation;
    // kick_rigid_bodies writes the next columns in this step:
    Column<Mat3> inverse_inertia;  // inverse inertia in the world frame [1/(kg m^2)]
    // Impulse of gravity and loads, and its moment about the centre of mass [N s, N m s].
    Column<Vec3> kick, moment_kick;
    // Accumulated from zero by solve_regions:
    // Impulse of contacts, and its moment about the centre of mass [N s, N m s].
    Column<Vec3> contact_impulse, contact_moment;
    Column<Vec3> push_velocity, push_spin;  // velocities that move the positions of this step only [m/s, rad/s]
    // Written by turn_rigid_bodies:
    Column<Vec3> center_next;
    Column<Mat3> rotation_next;
    // Written by strain_implicit_bodies: moments and axes of inertia of the new shape, and the rotation of its
    // principal frame before the rigid rotation of this step. Unchanged for rigid bodies and for bodies with small
    // deformation.
    Column<Vec3> moments_next;
    Column<Mat3> axes_next, rotation_shaped;
    // Angular impulse that keeps the frame of a held body on its path against the elastic forces in the body [N m s].
    Column<Vec3> hold_moment;
    Column<std::uint8_t> large_next;

    std::size_t size() const { return mass.size(); }

    /// Visits all columns. This is the only list of them. find_holders derives holder, held_position and held_rotation.
    /// `large` is hashed only if it is set.
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
