// Scripted motion of colliders and attachments.
#pragma once

#include <span>

#include "components/attachment_table.h"
#include "components/collider_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

/// Where a script is at time t. With keys: linear in position, constant angular velocity between keys, held before the
/// first and after the last. Without keys: initial pose moved by the constant velocities since the start of the script.
struct RigidPose {
    Vec3 position;
    Mat3 rotation;
};
RigidPose pose_at(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial, Real t);

/// The motion of a step from t to t + h: pose at t, and the velocities that lead to the pose at t + h.
RigidMotion motion_of_step(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial,
                           Real t, Real h);

/// rad, about a fixed axis, from one key's rotation to another's: by their difference where they are about one axis,
/// and so by whole turns, too; the shorter way else.
Vec3 turn_between(const Vec3& a, const Vec3& b);

/// rad/s, of the fastest turn of a script.
Real fastest_turn(const MotionScript& script, std::span<const Keyframe> keyframe);

struct ColliderMotionInputs {
    std::span<const MotionScript> script;
    std::span<const Keyframe> keyframe;
    std::span<const RigidMotion> initial;

    /// `table`: of colliders, or of attachments.
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
    std::span<const Vec3> anchor;         // m, in the moving frame

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
