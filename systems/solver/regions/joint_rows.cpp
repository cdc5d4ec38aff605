#include "systems/solver/regions/joint_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "systems/geometry/rotation.h"

namespace skerry {
namespace {

/// Motion of one body at the point of a joint, after the kick (the velocity change by forces).
struct BodyMotion {
    Vec3 arm = Vec3::Zero();  // vector from the centre to the joint point [m]
    // velocity of the centre, angular velocity [m/s, rad/s]
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
    Vec3 spin_rate = Vec3::Zero();  // angular acceleration of torque-free rotation [rad/s^2]

    BodyMotion(const RigidInputs& rigid, Index body, bool moves, const Vec3& point) {
        if (body == no_index) return;
        const auto r = static_cast<std::size_t>(body);
        arm = point - rigid.center[r];
        velocity = rigid.velocity(r);
        spin = rigid.spins.kicked(r);
        if (moves)
            spin_rate = rigid.spins.inverse_inertia[r] *
                        (rigid.spins.angular_momentum[r] + rigid.spins.moment_kick[r]).cross(spin);
    }
    Vec3 turning() const { return spin.cross(arm); }
    Vec3 at_point() const { return velocity + turning(); }
};

/// Half of the acceleration of the joint error, in the frame of the second body, while both bodies move freely [m/s^2
/// or rad/s^2]. Multiplied by h, it is the second-order part of the mean rate of the error in the step.
Vec3 half_acceleration(bool rotational, const BodyMotion& first, const BodyMotion& second) {
    if (rotational) return (first.spin_rate - second.spin_rate - second.spin.cross(first.spin - second.spin)) / 2;
    const Vec3 first_acceleration = first.spin.cross(first.turning()) + first.spin_rate.cross(first.arm);
    const Vec3 second_acceleration = second.spin.cross(second.turning()) - second.spin_rate.cross(second.arm);
    return (first_acceleration + second_acceleration) / 2 - second.spin.cross(first.at_point() - second.velocity);
}

/// Upper bound of the speed at which a joint error is corrected: recovery_speed (translation) or 1 rad/s (rotation),
/// plus the rotational speeds of both bodies. Faster corrections would cause jerks [m/s or rad/s]
Real max_correction_speed(const RegionStage& stage, bool rotational, const BodyMotion& first,
                          const BodyMotion& second) {
    constexpr Real turning = 1;  // [rad/s]
    return rotational ? turning + first.spin.norm() + second.spin.norm()
                      : stage.settings.recovery_speed + first.turning().norm() + second.turning().norm();
}

/// Sets the impulses of spring, damper and friction of a joint axis (docs/methods/joints.md 4).
void add_passive(const AxisLaw& axis, Real mobility, Real h, AxisBounds& bounds) {
    // Largest (omega h)^2, with omega^2 = stiffness * mobility, at which the spring force is evaluated only at the
    // start of the step. Up to this limit its energy error stays bounded. Stiffer springs are evaluated partly at the
    // end of the step.
    constexpr Real at_start = 0.5;
    const JointPassiveRow& passive = axis.passive;
    const Real frequency = h * axis.kick * passive.stiffness * mobility;
    const Real at_end = frequency > at_start ? 1 - at_start / frequency : 0;
    bounds.pull = axis.kick * passive.stiffness * (passive.rest - axis.coordinate);
    bounds.drag = axis.kick * (passive.damping + at_end * passive.stiffness * h);
    bounds.friction = axis.kick * passive.friction;
}

/// Limits, motor and passive forces of a joint axis as bounds of its velocity and impulse. `mobility` is the mobility
/// of the axis [1/kg or 1/(kg m^2)].
AxisBounds bounds_of(const AxisLaw& axis, Real mobility, Real h, Real max_speed) {
    AxisBounds bounds;
    bounds.low = std::min((axis.lower - axis.coordinate) / h, max_speed);
    bounds.high = std::max((axis.upper - axis.coordinate) / h, -max_speed);
    add_passive(axis, mobility, h, bounds);
    if (axis.drive == JointDrive::none) return bounds;
    bounds.max_impulse = axis.kick * axis.motor.most;
    bounds.target = axis.motor.target;
    if (axis.drive == JointDrive::speed) return bounds;
    const Real distance = axis.motor.target - axis.coordinate;
    // Greatest speed from which half of the motor force `most` stops the joint within `distance`: v^2 = 2 a |distance|
    // with the deceleration a = most mobility / 2. The other half of the force is reserved for loads.
    const Real braking_speed = std::sqrt(axis.motor.most * mobility * std::abs(distance));
    const Real approach_speed = std::copysign(std::min(std::abs(distance) / h, braking_speed), distance);
    bounds.target = std::clamp(axis.target_rate + approach_speed, -axis.motor.most_speed, axis.motor.most_speed);
    return bounds;
}

/// Velocity along the joint rows that corrects the position error of the joint block [m/s or rad/s]
Vec3 correction_velocity(const JointBlock& block, Real h, Real max_speed) {
    Vec3 pull = block.error / h;
    if (!block.axis.locked) pull.z() = 0;
    const Real speed = pull.norm();
    return speed > max_speed ? Vec3(max_speed / speed * pull) : pull;
}

/// Centre of a body before and after the step, and its rotation in the step, for the given velocities.
struct BodyEnd {
    Vec3 center = Vec3::Zero(), center_next = Vec3::Zero();
    Mat3 turn = Mat3::Identity();

    BodyEnd(const RegionStage& stage, Index body, Index slot, std::span<const Vec4> velocity) {
        if (body == no_index) return;
        const RigidInputs& rigid = stage.inputs.rigid;
        const auto r = static_cast<std::size_t>(body);
        center = rigid.center[r];
        if (slot == no_index) {  // the body has no velocity rows, because impulses cannot move it
            center_next = center + stage.h * rigid.velocity(r);
            turn = rotation_matrix(stage.h * rigid.spins.kicked(r));
            return;
        }
        const auto at = static_cast<std::size_t>(slot);
        const Vec3 spin = velocity[at + 1].head<3>();
        const Mat3& inverse = rigid.spins.inverse_inertia[r];
        const Vec3 rate = inverse * (inverse.inverse() * spin).cross(spin);
        center_next = center + stage.h * velocity[at].head<3>();
        turn = rotation_matrix(stage.h * (spin + stage.h / 2 * rate));
    }
    Vec3 moved(const Vec3& point) const { return center_next + turn * (point - center); }
};

/// Error of a joint block at the end of the step, in the joint axes at the end of the step [m or rad]
Vec3 error_at_end(const JointBlock& block, const BodyEnd& first, const BodyEnd& second) {
    const Mat3 frame = second.turn * block.frame;
    if (!block.turning)
        return frame.transpose() * (first.moved(block.point) - second.moved(block.point - block.frame * block.error));
    if (block.axis.locked) {
        const Mat3 first_rotation = first.turn * rotation_matrix(block.frame * block.error);
        return frame.transpose() * rotation_vector(first_rotation * second.turn.transpose());
    }
    const Vec3 axis = block.frame.col(2), tilt = block.frame * Vec3(block.error.x(), block.error.y(), 0);
    const Vec3 moved_axis = std::sqrt(std::max(Real(0), 1 - tilt.squaredNorm())) * axis + tilt.cross(axis);
    return frame.transpose() * frame.col(2).cross(first.turn * moved_axis);
}

void add_term(const RegionStage& stage, const JointBlock& block, Index body, Real sign, std::span<const Index> rigid,
              RigidPart& part) {
    const auto r = static_cast<std::size_t>(body);
    RigidTerm& term = part.term[static_cast<std::size_t>(part.term_count++)];
    const auto rigid_index = std::find(rigid.begin(), rigid.end(), body) - rigid.begin();
    term = {.row = body, .slot = static_cast<Index>(2 * rigid_index), .arm = Vec4::Zero(), .spin_step = {}};
    const Mat3& inverse_inertia = stage.inputs.rigid.spins.inverse_inertia[r];
    if (block.turning) {
        term.spin_coefficient = sign;
        term.spin_step = columns_of(sign * inverse_inertia);
        return;
    }
    term.weight = sign;
    term.step = sign / stage.inputs.rigid.mass[r];
    term.arm = sign * padded(block.point - stage.inputs.rigid.center[r]);
    term.spin_step = columns_of(inverse_inertia * cross_matrix(term.arm.head<3>()));
}

}  // namespace

void load_joint(const RegionStage& stage, const JointBlock& block, std::span<const Index> rigid,
                const LoadedJoint& loaded) {
    const bool first_moves = block.first_node != no_index, second_moves = block.second_node != no_index;
    const BodyMotion first(stage.inputs.rigid, block.first, first_moves, block.point);
    const BodyMotion second(stage.inputs.rigid, block.second, second_moves, block.point);
    const Real max_speed = max_correction_speed(stage, block.turning, first, second);
    const bool with_axis = !block.axis.locked;

    RigidPart& part = loaded.part;
    part.term_count = 0;
    if (first_moves) add_term(stage, block, block.first, 1, rigid, part);
    if (second_moves) add_term(stage, block, block.second, -1, rigid, part);
    part.frame = columns_of(block.frame);
    const Mat3 mobility = rigid_coupling(part, part);
    part.mobility = columns_of(mobility);
    part.along_normal = part.max_eigenvalue = mobility.norm();
    loaded.law.mimic = block.mimic.coefficient;
    loaded.law.axis_free = false;
    if (loaded.law.mimic == 0) loaded.law.prepare(block.frame.transpose() * mobility * block.frame, with_axis);
    loaded.law.axis = with_axis ? bounds_of(block.axis, loaded.law.axis_mobility, stage.h, max_speed) : AxisBounds{};

    Vec3 bias = correction_velocity(block, stage.h, max_speed) +
                stage.h * (block.frame.transpose() * half_acceleration(block.turning, first, second));
    if (with_axis) bias.z() = 0;
    Vec3 offset = block.frame * bias;
    if (!first_moves) offset += block.turning ? first.spin : first.at_point();
    if (!second_moves) offset -= block.turning ? second.spin : second.at_point();

    LumpedContact& contact = loaded.contact;
    contact = LumpedContact{};
    contact.normal = part.frame[2];
    contact.offset = padded(offset);
    contact.diagonal = mobility.trace() / 3;
    contact.inverse_diagonal = contact.diagonal > 0 ? 1 / contact.diagonal : 0;
}

void load_mimic(const LoadedJoint& first, const LoadedJoint& leader) {
    constexpr Real rounding = 1e-12;  // a sum below this fraction of the sum of absolute terms counts as mobility 0
    Real sum = 0, size = 0;
    for (const LoadedJoint* a : {&first, &leader})
        for (const LoadedJoint* b : {&first, &leader}) {
            const Mat3 coupling = rigid_coupling(a->part, b->part);
            const Real term =
                a->law.mimic * b->law.mimic * a->part.frame[2].head<3>().dot(coupling * b->part.frame[2].head<3>());
            sum += term;
            size += std::abs(term);
        }
    const Vec3 axis = first.part.frame[2].head<3>();
    const bool moves = sum > rounding * size;
    first.part.mobility = columns_of(sum * axis * axis.transpose());
    first.contact.diagonal = moves ? sum : 0;
    first.contact.inverse_diagonal = moves ? 1 / sum : 0;
    leader.part.mobility = columns_of(Mat3(Mat3::Zero()));
    leader.contact.diagonal = leader.contact.inverse_diagonal = 0;
}

Real correct_joint(const RegionStage& stage, const JointBlock& block, std::span<const Vec4> velocity,
                   const LoadedJoint& loaded) {
    const bool first_moves = block.first_node != no_index, second_moves = block.second_node != no_index;
    const RigidPart& part = loaded.part;
    const Index first_slot = first_moves ? part.term[0].slot : no_index;
    const Index second_slot = second_moves ? part.term[first_moves ? 1 : 0].slot : no_index;
    const BodyEnd first(stage, block.first, first_slot, velocity), second(stage, block.second, second_slot, velocity);
    const BodyMotion first_before(stage.inputs.rigid, block.first, first_moves, block.point);
    const BodyMotion second_before(stage.inputs.rigid, block.second, second_moves, block.point);
    const Real max_speed = max_correction_speed(stage, block.turning, first_before, second_before);
    const Vec3 remaining_error = block.error - stage.h * correction_velocity(block, stage.h, max_speed);
    Vec3 velocity_error = (error_at_end(block, first, second) - remaining_error) / stage.h;
    if (!block.axis.locked) velocity_error.z() = 0;
    loaded.contact.offset += padded(block.frame * velocity_error);
    return loaded.contact.inverse_diagonal * velocity_error.squaredNorm();
}

void add_joint(const LoadedJoint& loaded, const Vec4& u, LoadSums& sums) {
    const Vec3 row_velocity = matrix_of(loaded.part.frame).transpose() * u.head<3>();
    const Vec3 residual = loaded.law.natural_map(Vec3::Zero(), row_velocity, loaded.contact.diagonal);
    sums.inverse_diagonals += loaded.contact.inverse_diagonal;
    sums.moving += loaded.contact.inverse_diagonal * u.squaredNorm();
    if (residual.isZero(0)) return;
    sums.separating = false;
    sums.squared_residual += loaded.contact.diagonal * residual.squaredNorm();
}

}  // namespace skerry
