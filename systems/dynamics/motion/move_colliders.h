// Scripted motion of colliders and attachments.
#pragma once

#include <span>

#include "components/attachment_table.h"
#include "components/collider_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

/// Pose of a motion script at time t:
/// - With keys: between two keys position is linear in time and angular velocity is constant. Before the first and
///   after the last key the pose is constant.
/// - Without keys: the initial pose moves at the constant velocities of the script from its start time on.
struct RigidPose {
    Vec3 position;
    Mat3 rotation;
};
RigidPose pose_at(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial, Real t);

/// Motion of a script in the step from t to t + h: the pose at t, and the velocities that lead to the pose at t + h.
RigidMotion motion_of_step(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial,
                           Real t, Real h);

/// Rotation vector from the rotation of one key to the rotation of another key, about a fixed axis [rad]. If the
/// rotation vectors of both keys are parallel, the result is their difference and may contain full rotations. Otherwise
/// the result is the shorter rotation.
Vec3 turn_between(const Vec3& a, const Vec3& b);

/// Greatest angular speed of a motion script [rad/s].
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
    std::span<const RigidMotion> motion;  // by row of AttachmentTable
    std::span<const Range> nodes;         // by attachment: range of its entries in `node` and `anchor`
    std::span<const Index> node;          // rows of NodeTable
    std::span<const Vec3> anchor;         // position in the frame of the attachment [m]
    std::span<const Mat3> held;           // by attachment; columns: held directions

    static NodeMotionInputs bind(const Binder& binder, const AttachmentTable& attachment) {
        return {.motion = binder.read(attachment.motion),
                .nodes = binder.read(attachment.nodes),
                .node = binder.read(attachment.node),
                .anchor = binder.read(attachment.anchor),
                .held = binder.read(attachment.held)};
    }
};

/// Sets the velocity of every node that is held completely, so that the node moves in a straight line to its position
/// at the end of the step: velocity = (end pose applied to anchor - position) / h.
void drive_nodes(const NodeMotionInputs& followers, Real h, std::span<const Vec3> position, std::span<Vec3> velocity);

}  // namespace skerry
