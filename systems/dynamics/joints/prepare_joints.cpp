#include "systems/dynamics/joints/prepare_joints.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Hinge angle between the first and the second frame, about the third axis of the second frame [rad]. A rotation by
/// this angle moves the first axis of the second frame as close as possible to the first axis of the first frame.
Real angle_between(const Mat3& first, const Mat3& second) {
    return std::atan2(first.col(0).dot(second.col(1)), first.col(0).dot(second.col(0)));
}

/// Rotation vector of the first frame relative to the second, in axes of the second frame [rad]. For a hinge, the cross
/// product of the two hinge axes is used instead, because a rotation about the hinge is no error.
Vec3 turning_error(JointKind kind, const Mat3& first, const Mat3& second) {
    if (kind != JointKind::hinge) return second.transpose() * rotation_vector(first * second.transpose());
    return second.transpose() * second.col(2).cross(first.col(2));
}

/// Start `t` and length `h` of the step, and length `kick` of its force interval [s].
struct StepTimes {
    Real t, h, kick;
};

AxisLaw axis_of(const JointInputs& joints, std::size_t j, Real coordinate, const StepTimes& step) {
    AxisLaw axis{.locked = false,
                 .coordinate = coordinate,
                 .lower = joints.lower[j],
                 .upper = joints.upper[j],
                 .drive = joints.drive[j],
                 .motor = joints.motor[j],
                 .passive = joints.passive[j],
                 .kick = step.kick};
    if (axis.drive == JointDrive::position) {
        axis.motor.target = joints.target(j, step.t);
        axis.target_rate = (joints.target(j, step.t + step.h) - axis.motor.target) / step.h;
    } else {
        axis.motor.target = joints.mean_target(j, step.t, step.h);
    }
    return axis;
}

/// Vector from the point of joint `j` to the point at which its equations are formed, along the axes of the second
/// frame [m]. Of the possible points the one nearest to the centre of mass is used, because velocity and spin are
/// coupled least there:
/// - Ball joint: the point of the joint.
/// - Hinge: any point on its axis.
/// - Bodies that cannot rotate relative to each other: any point, because their relative velocity is equal at all
///   points.
Vec3 shift_of(const JointInputs& joints, std::size_t j, const JointPose& first, const JointPose& second) {
    if (joints.kind[j] == JointKind::ball) return Vec3::Zero();
    Vec3 sum = Vec3::Zero();
    Real weights = 0;
    for (const Index body : {joints.first[j], joints.second[j]}) {
        if (joints.moving_node(body) == no_index) continue;
        const auto r = static_cast<std::size_t>(joints.rigid(body));
        // If both bodies move, the weighted mean of their centres of mass is used.
        const Real weight = joints.moments[r].cwiseInverse().sum();
        sum += weight * joints.center[r];
        weights += weight;
    }
    const Vec3 shift = second.axes.transpose() * (sum / weights - first.point);
    return joints.kind[j] == JointKind::hinge ? Vec3(0, 0, shift.z()) : shift;
}

/// Block of joint `j` in a mimic equation, which couples the coordinates of two joints (MimicShare). `coordinate`:
/// angle or displacement of joint `j`.
struct MimicAxis {
    JointBlock block;
    Real coordinate;

    MimicAxis(const JointInputs& joints, std::size_t j, bool leads, Real coefficient) {
        const JointPose first = joints.place(joints.first[j], joints.first_frame[j]),
                        second = joints.place(joints.second[j], joints.second_frame[j]);
        coordinate = joint_coordinate(joints.kind[j], first, second, joints.coordinate[j]);
        block = {.joint = static_cast<Index>(j),
                 .turning = joints.kind[j] == JointKind::hinge,
                 .first = joints.rigid(joints.first[j]),
                 .second = joints.rigid(joints.second[j]),
                 .first_node = joints.moving_node(joints.first[j]),
                 .second_node = joints.moving_node(joints.second[j]),
                 .point = first.point,
                 .frame = second.axes,
                 .error = Vec3::Zero(),
                 .axis = {},
                 .mimic = {.coefficient = coefficient, .leads = leads}};
    }
};

/// Appends the two blocks of the mimic equation of joint `j`: first its own block, then that of its leader.
void add_mimic(const JointInputs& joints, std::size_t j, Real kick, JointBlockTable& blocks) {
    const auto leader = static_cast<std::size_t>(joints.leader[j]);
    const MimicRow& mimic = joints.mimic[j];
    MimicAxis own(joints, j, false, 1), other(joints, leader, true, -mimic.ratio);
    own.block.mimic.other_node = other.block.own_node();
    other.block.mimic.other_node = own.block.own_node();
    if (own.block.moving_node() == no_index) return;
    own.block.error.z() = own.coordinate - mimic.ratio * other.coordinate - mimic.offset;
    const Real impulse = joints.step[j] > 0 ? kick / joints.step[j] * joints.mimic_impulse[j] : 0;
    for (const JointBlock& block : {own.block, other.block}) {
        blocks.block.push_back(block);
        blocks.impulse.push_back({0, 0, block.mimic.coefficient * impulse});
    }
}

}  // namespace

JointPose JointInputs::place(Index body, const JointFrame& frame) const {
    if (body == no_index) return {frame.point, frame.axes};
    const auto r = static_cast<std::size_t>(rigid(body));
    const Mat3 from_mesh = rotation[r] * axes[r].transpose();
    return {center[r] + from_mesh * (frame.point - rest_center[r]), from_mesh * frame.axes};
}

Real JointInputs::target(std::size_t j, Real t) const {
    return keys_of(j).empty() ? motor[j].target : value_at(keys_of(j), t);
}

bool JointInputs::target_moves(std::size_t j, Real t, Real h) const {
    return drive[j] != JointDrive::none && !keys_of(j).empty() && changes(keys_of(j), t, h);
}

Real JointInputs::mean_target(std::size_t j, Real t, Real h) const {
    return keys_of(j).empty() ? motor[j].target : mean_value(keys_of(j), t, h);
}

Real joint_coordinate(JointKind kind, const JointPose& first, const JointPose& second, Real before) {
    if (kind == JointKind::slider) return second.axes.col(2).dot(first.point - second.point);
    if (kind != JointKind::hinge) return 0;
    constexpr Real turn = 2 * std::numbers::pi;
    const Real angle = angle_between(first.axes, second.axes);
    return angle + turn * std::round((before - angle) / turn);
}

bool prepare_joints(const JointInputs& joints, Real t, Real h, Real kick, JointBlockTable& blocks) {
    const StepTimes step{t, h, kick};
    blocks.block.clear();
    blocks.impulse.clear();
    blocks.coordinate.resize(joints.size());
    blocks.resting.resize(joints.size());
    for (std::size_t j = 0; j < joints.size(); ++j) {
        blocks.resting[j] = joints.rests(j);
        if (blocks.resting[j]) continue;
        const JointKind kind = joints.kind[j];
        const JointPose first = joints.place(joints.first[j], joints.first_frame[j]),
                        second = joints.place(joints.second[j], joints.second_frame[j]);
        blocks.coordinate[j] = joint_coordinate(kind, first, second, joints.coordinate[j]);
        JointBlock block{.joint = static_cast<Index>(j),
                         .turning = false,
                         .first = joints.rigid(joints.first[j]),
                         .second = joints.rigid(joints.second[j]),
                         .first_node = joints.moving_node(joints.first[j]),
                         .second_node = joints.moving_node(joints.second[j]),
                         .point = first.point,
                         .frame = second.axes,
                         .error = second.axes.transpose() * (first.point - second.point),
                         .axis = {}};
        if (block.first_node == no_index && block.second_node == no_index) continue;
        block.shift = shift_of(joints, j, first, second);
        block.point += first.axes * block.shift;
        block.error += second.axes.transpose() * first.axes * block.shift - block.shift;
        const Real scale = joints.step[j] > 0 ? kick / joints.step[j] : 0;
        if (kind == JointKind::slider) block.axis = axis_of(joints, j, blocks.coordinate[j], step);
        blocks.block.push_back(block);
        blocks.impulse.push_back(scale * joints.impulse[j]);
        if (kind == JointKind::ball) continue;
        block.turning = true;
        block.error = turning_error(kind, first.axes, second.axes);
        block.axis = kind == JointKind::hinge ? axis_of(joints, j, blocks.coordinate[j], step) : AxisLaw{};
        blocks.block.push_back(block);
        blocks.impulse.push_back(scale * (joints.moment[j] - block.shift.cross(joints.impulse[j])));
    }
    for (std::size_t j = 0; j < joints.size(); ++j)
        if (joints.leader[j] != no_index && blocks.resting[j] == 0) add_mimic(joints, j, kick, blocks);
    blocks.axis_impulse.assign(blocks.size(), {});
    return joints.size() > 0;
}

bool mark_driven(const JointInputs& joints, Real t, Real h, std::span<std::uint8_t> marked) {
    bool any = false;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        if (!joints.target_moves(j, t, h)) continue;
        any = true;
        for (const Index body : {joints.first[j], joints.second[j]})
            if (body != no_index) marked[static_cast<std::size_t>(body)] = 1;
    }
    return any;
}

bool store_joints(const JointBlockTable& blocks, Real kick, const JointMemory& out) {
    for (std::size_t j = 0; j < out.step.size(); ++j) {
        if (blocks.resting[j]) continue;
        out.coordinate[j] = blocks.coordinate[j];
        out.impulse[j] = out.moment[j] = Vec3::Zero();
        out.axis_impulse[j] = {};
        out.mimic_impulse[j] = 0;
        out.step[j] = kick;
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const auto j = static_cast<std::size_t>(blocks.block[i].joint);
        const MimicShare& mimic = blocks.block[i].mimic;
        if (mimic.coefficient != 0) {
            if (!mimic.leads) out.mimic_impulse[j] = blocks.impulse[i].z();
            continue;
        }
        if (blocks.block[i].turning)
            out.moment[j] = blocks.impulse[i] + blocks.block[i].shift.cross(out.impulse[j]);
        else
            out.impulse[j] = blocks.impulse[i];
        out.impulse_axes[j] = blocks.block[i].frame;
        if (!blocks.block[i].axis.locked) out.axis_impulse[j] = blocks.axis_impulse[i];
    }
    return out.step.size() > 0;
}

}  // namespace skerry
