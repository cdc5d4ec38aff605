// Rigid bodies that an attachment holds: such a body follows the motion of the attachment (docs/methods/rigid_bodies.md
// 5).
#pragma once

#include <span>

#include "components/attachment_table.h"
#include "components/rigid_body_table.h"
#include "components/types.h"
#include "jobs/access.h"
#include "systems/dynamics/rigid/rigid_motion.h"
#include "systems/geometry/rotation.h"

namespace skerry {

struct RigidHolds {
    // Columns of RigidBodyTable: the attachment that holds the body, or no_index, and the pose of the body's mesh in
    // the frame of this attachment [m].
    std::span<const Index> holder;
    std::span<const Vec3> held_position;
    std::span<const Mat3> held_rotation;
    std::span<const RigidMotion> motion;  // column of AttachmentTable: motion of the attachment in this step

    static RigidHolds bind(const Binder& binder, const RigidBodyTable& rigid, const AttachmentTable& attachment) {
        return {.holder = binder.read(rigid.holder),
                .held_position = binder.read(rigid.held_position),
                .held_rotation = binder.read(rigid.held_rotation),
                .motion = binder.read(attachment.motion)};
    }

    bool hold(std::size_t r) const { return holder[r] != no_index; }
    const RigidMotion& motion_of(std::size_t r) const { return motion[static_cast<std::size_t>(holder[r])]; }
};

/// Pose of a held body at the end of the step. drive_nodes moves the nodes of the body to this pose.
struct HeldPose {
    Vec3 center;
    Mat3 rotation;  // rotation from the principal frame to the world

    HeldPose(const RigidHolds& holds, std::size_t r, Real h, const Vec3& rest_center, const Mat3& axes) {
        const RigidMotion& motion = holds.motion_of(r);
        const Mat3 turned = rotation_matrix(h * motion.angular_velocity) * motion.rotation;
        const Mat3 from_mesh = turned * holds.held_rotation[r];
        rotation = from_mesh * axes;
        center = motion.position + h * motion.velocity + turned * holds.held_position[r] + from_mesh * rest_center;
    }
};

}  // namespace skerry
