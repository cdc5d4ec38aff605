// Scripted motion of colliders and attachments.
#pragma once

#include <span>

#include "components/attachment_table.h"
#include "components/collider_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

/// Pose of a script at time t. With keys: linear in position, constant angular velocity between keys, constant before
/// the first and after the last. Without keys: initial pose moved by the constant velocities since the start of the
/// script.
struct RigidPose {
    Vec3 position;
    Mat3 rotation;
};
RigidPose pose_at(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial, Real t);

/// The motion of a step from t to t + h: pose at t, and the velocities that lead to the pose at t + h.
RigidMotion motion_of_step(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial,
                           Real t, Real h);

/// Rotation vector, about a fixed axis, from one key's rotation to another's [rad]. If both are about one axis it is
/// their difference and may contain whole turns; otherwise it is the shorter way.
Vec3 turn_between(const Vec3& a, const Vec3& b);

/// Greatest angular speed of a script [rad/s].
Real fastest_turn(const MotionScript& script, std::span<const Keyframe> keyframe);

struct ColliderMotionInputs {
    std::span<const MotionScript> script;
    std::span<const Keyframe> keyframe;
    std::span<const RigidMotion> initial;

    /// `table`: ColliderTable or AttachmentTable.
    static ColliderMotionInputs bind(const Binder& binder, const auto& table) {
        return {binder.read(table.script), binder.read(table.keyframe), binder.read(table.initial)};
    }
};

/// Writes the motion of every collider for the step from t to t + h.
void move_colliders(const ColliderMotionInputs& colliders, Real t, Real h, std::span<RigidMotion> motion);

struct NodeMotionInputs {
    std::span<const RigidMotion> motion;  // by attachment or collider
    std::span<const Range> nodes;         // by attachment: range in node and anchor
    std::span<const Index> node;          // rows of NodeTable
    std::span<const Vec3> anchor;         // in the moving frame [m]

    static NodeMotionInputs bind(const Binder& binder, const AttachmentTable& attachment) {
        return {.motion = binder.read(attachment.motion),
                .nodes = binder.read(attachment.nodes),
                .node = binder.read(attachment.node),
                .anchor = binder.read(attachment.anchor)};
    }
};

/// Gives every node that follows a motion the velocity that takes it from where it is to where the motion ends:
/// velocity = (end pose applied to anchor - position) / h.
void drive_nodes(const NodeMotionInputs& followers, Real h, std::span<const Vec3> position, std::span<Vec3> velocity);

}  // namespace skerry
