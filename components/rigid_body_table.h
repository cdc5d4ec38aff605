// One row per rigid or implicit body: the rigid motion of the body (docs/methods/rigid_bodies.md).
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

/// Rigid motion of each rigid or implicit body. The principal frame of a body has its origin in the centre of mass and
/// its axes along the principal axes of inertia. `axes` maps vectors from it to the frame of the mesh, `rotation` to
/// the world frame.
///
/// Position of a node of a rigid body: center + rotation axes^T (rest_position - rest_center).
struct RigidBodyTable {
    Column<Index> body;  // row of BodyTable
    Column<Real> mass;   // [kg]
    // The next two columns describe the mass distribution of the rest shape, or of the present shape if `large` is 1.
    Column<Vec3> moments;           // moments of inertia about the principal axes [kg m^2]
    Column<Mat3> axes;              // columns: directions of the principal axes in the frame of the mesh
    Column<Vec3> rest_center;       // centre of mass in the frame of the mesh [m]
    Column<Vec3> center;            // centre of mass in the world frame [m]
    Column<Mat3> rotation;          // maps vectors from the principal frame to the world frame
    Column<Vec3> momentum;          // [kg m/s]
    Column<Vec3> angular_momentum;  // angular momentum about the centre of mass [kg m^2/s]
    // 1: the deformation is large and is computed with the nonlinear laws of the elements.
    Column<std::uint8_t> large;
    // `holder`: the attachment that holds a rigid body or the frame of an implicit body. `held_position` and
    // `held_rotation`: pose of the frame of the mesh in the frame of this attachment.
    Column<Index> holder;        // row of AttachmentTable, or no_index
    Column<Vec3> held_position;  // [m]
    Column<Mat3> held_rotation;
    // kick_rigid_bodies writes the next columns in this step.
    Column<Mat3> inverse_inertia;  // inverse inertia in the world frame [1/(kg m^2)]
    // Impulse of gravity and external loads in this step, and their angular impulse about the centre of mass [N s, N m
    // s].
    Column<Vec3> kick, moment_kick;
    // The columns from contact_impulse to push_spin are zero when the step begins, and solve_regions adds to them. The
    // first two contain the impulse of all contacts, and their angular impulse about the centre of mass [N s, N m s].
    Column<Vec3> contact_impulse, contact_moment;
    // Velocity and angular velocity of the push-out, the motion that separates overlapping bodies. They change the pose
    // in this step, but not the momentum [m/s, rad/s].
    Column<Vec3> push_velocity, push_spin;
    // turn_rigid_bodies writes the next two columns.
    Column<Vec3> center_next;
    Column<Mat3> rotation_next;
    // Moments and axes of inertia of the new shape, and rotation of its principal frame without the rigid rotation of
    // this step. strain_implicit_bodies writes them for bodies with large deformation. For all other bodies they equal
    // `moments`, `axes` and `rotation`.
    Column<Vec3> moments_next;
    Column<Mat3> axes_next, rotation_shaped;
    // Angular impulse of the attachment on a held implicit body. It balances the elastic forces, so that the frame of
    // the body follows its prescribed motion [N m s].
    Column<Vec3> hold_moment;
    Column<std::uint8_t> large_next;

    std::size_t size() const { return mass.size(); }

    /// Visits all columns. This is the only list of the columns. find_holding_attachments derives holder, held_position
    /// and held_rotation. `large` is hashed only if it is 1.
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
