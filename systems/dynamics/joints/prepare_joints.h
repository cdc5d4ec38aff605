// Prepares the velocity equations of the joints in this step (docs/methods/joints.md 2).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/joint_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"

namespace skerry {

/// Present pose of a joint frame in world coordinates. The frame is fixed to one body of the joint, or to the world.
struct JointPose {
    Vec3 point;
    Mat3 axes;
};

struct JointInputs {
    std::span<const JointKind> kind;
    std::span<const JointDrive> drive;
    std::span<const Index> first, second;
    std::span<const JointFrame> first_frame, second_frame;
    std::span<const Real> lower, upper;
    std::span<const JointMotorRow> motor;
    std::span<const JointPassiveRow> passive;
    std::span<const Range> motor_keys;
    std::span<const TimeKey> key;
    std::span<const Index> leader;
    std::span<const MimicRow> mimic;
    std::span<const Real> mimic_impulse;
    std::span<const Real> coordinate;
    std::span<const Vec3> impulse, moment;
    std::span<const Real> step;
    std::span<const Range> body_rigid, body_nodes;  // BodyTable
    std::span<const std::uint8_t> body_asleep;      // column of BodyTable; empty if no body is asleep
    // RigidBodyTable
    std::span<const Index> holder;
    std::span<const Vec3> center, rest_center, moments;
    std::span<const Mat3> axes, rotation;

    static JointInputs bind(const Binder& binder, const JointTable& joint, const BodyTable& body,
                            const RigidBodyTable& rigid, const bool& any_asleep) {
        return {.kind = binder.read(joint.kind),
                .drive = binder.read(joint.drive),
                .first = binder.read(joint.first),
                .second = binder.read(joint.second),
                .first_frame = binder.read(joint.first_frame),
                .second_frame = binder.read(joint.second_frame),
                .lower = binder.read(joint.lower),
                .upper = binder.read(joint.upper),
                .motor = binder.read(joint.motor),
                .passive = binder.read(joint.passive),
                .motor_keys = binder.read(joint.motor_keys),
                .key = binder.read(joint.key),
                .leader = binder.read(joint.leader),
                .mimic = binder.read(joint.mimic),
                .mimic_impulse = binder.read(joint.mimic_impulse),
                .coordinate = binder.read(joint.coordinate),
                .impulse = binder.read(joint.impulse),
                .moment = binder.read(joint.moment),
                .step = binder.read(joint.step),
                .body_rigid = binder.read(body.rigid),
                .body_nodes = binder.read(body.nodes),
                .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep),
                .holder = binder.read(rigid.holder),
                .center = binder.read(rigid.center),
                .rest_center = binder.read(rigid.rest_center),
                .moments = binder.read(rigid.moments),
                .axes = binder.read(rigid.axes),
                .rotation = binder.read(rigid.rotation)};
    }

    std::size_t size() const { return kind.size(); }
    /// Row of RigidBodyTable of a body; no_index for the world.
    Index rigid(Index body) const {
        return body == no_index ? no_index : body_rigid[static_cast<std::size_t>(body)].begin;
    }
    /// First node of a body; no_index for the world and for a body held by an attachment, which impulses cannot move.
    Index moving_node(Index body) const {
        const Index row = rigid(body);
        if (row == no_index || holder[static_cast<std::size_t>(row)] != no_index) return no_index;
        return body_nodes[static_cast<std::size_t>(body)].begin;
    }
    /// True if each body of joint `j` is asleep, held by an attachment, or the world. Always false while no body is
    /// asleep, because body_asleep is then empty.
    bool rests(std::size_t j) const {
        const auto is_out = [&](Index body) {
            return moving_node(body) == no_index || body_asleep[static_cast<std::size_t>(body)] != 0;
        };
        return !body_asleep.empty() && is_out(first[j]) && is_out(second[j]);
    }
    JointPose place(Index body, const JointFrame& frame) const;
    /// Target of the motor of joint `j` at time `t`: a speed or a position, with the unit of JointMotorRow::target.
    Real target(std::size_t j, Real t) const;
    /// True if joint `j` has a motor whose target changes in the step of length `h` that starts at time `t`.
    bool target_moves(std::size_t j, Real t, Real h) const;
    /// Mean target of the motor of joint `j` in the step of length `h` that starts at time `t`.
    Real mean_target(std::size_t j, Real t, Real h) const;
    std::span<const TimeKey> keys_of(std::size_t j) const { return rows_of(key, motor_keys[j]); }
};

/// Displacement of a slider [m] or angle of a hinge [rad] between the joint frames of the two bodies; 0 for other kinds
/// of joints. Full rotations of a hinge are counted: the result is the angle nearest to `before`.
Real joint_coordinate(JointKind kind, const JointPose& first, const JointPose& second, Real before);

/// Writes the constraint blocks (three equations each) of all joints with a moving body, for the step of length `h`
/// that starts at time `t`. The impulses of the last step serve as the warm start of the solver. `kick`: time for which
/// forces act, including the forces of motors [s]. Returns false if there is no joint (skipped).
bool prepare_joints(const JointInputs& joints, Real t, Real h, Real kick, JointBlockTable& blocks);

/// Marks the bodies of joints whose motor has a target that changes in this step. Returns false if no target changes.
bool mark_driven(const JointInputs& joints, Real t, Real h, std::span<std::uint8_t> marked);

/// Columns of JointTable that a committed step stores for the next step.
struct JointMemory {
    std::span<Real> coordinate;
    std::span<Vec3> impulse, moment;
    std::span<Mat3> impulse_axes;
    std::span<AxisImpulses> axis_impulse;
    std::span<Real> mimic_impulse, step;

    static JointMemory bind(const Binder& binder, JointTable& joint) {
        return {.coordinate = binder.write(joint.coordinate),
                .impulse = binder.write(joint.impulse),
                .moment = binder.write(joint.moment),
                .impulse_axes = binder.write(joint.impulse_axes),
                .axis_impulse = binder.write(joint.axis_impulse),
                .mimic_impulse = binder.write(joint.mimic_impulse),
                .step = binder.write(joint.step)};
    }
};

/// Stores the coordinates and impulses of the joints for the next step, and the time `kick` for which the impulses
/// acted [s]. Joints whose bodies all rest (JointInputs::rests) keep their old values. Returns false if there is no
/// joint (skipped).
bool store_joints(const JointBlockTable& blocks, Real kick, const JointMemory& out);

}  // namespace skerry
