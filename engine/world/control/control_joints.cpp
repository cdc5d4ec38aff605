// Functions that add, remove and drive joints between steps (docs/methods/joints.md).
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/objects.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/validate.h"
#include "skerry/joint.h"
#include "systems/contact/tangent_frame.h"
#include "systems/dynamics/joints/prepare_joints.h"
#include "systems/dynamics/rigid/rigid_motion.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_joint(const char* field, const std::string& found, const std::string& expected) {
    refuse("joint", field, found, expected);
}

bool has_axis(JointKind kind) {
    return kind == JointKind::hinge || kind == JointKind::slider;
}

Index rigid_body_of(const Model& model, BodyHandle body, const char* field) {
    const Index row = model.row(body, "add_joint");
    if (!model.is_rigid(static_cast<std::size_t>(row)))
        refuse_joint(field, "body '" + model.body_records[static_cast<std::size_t>(row)].name + "', which deforms",
                     "a rigid body");
    return row;
}

void validate_keys(const std::vector<MotorKey>& keys) {
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const MotorKey& key = keys[k];
        const std::string field = "motor.keys[" + std::to_string(k) + "]";
        if (key.speed.has_value() == key.position.has_value())
            refuse_joint(field.c_str(), key.speed ? "a speed and a position" : "neither a speed nor a position",
                         "either a speed or a position");
        if (key.speed.has_value() != keys.front().speed.has_value())
            refuse_joint(field.c_str(), key.speed ? "a speed" : "a position",
                         key.speed ? "a position, as in the first key" : "a speed, as in the first key");
        const Real target = key.speed.value_or(key.position.value_or(0));
        if (!std::isfinite(target))
            refuse_joint((field + (key.speed ? ".speed" : ".position")).c_str(), short_text(target), "a finite number");
        if (!std::isfinite(key.time) || (k > 0 && !(key.time > keys[k - 1].time)))
            refuse_joint((field + ".time").c_str(), short_text(key.time, 9) + " s",
                         k > 0 ? "a time after that of the key before, " + short_text(keys[k - 1].time, 9) + " s"
                               : "a finite number");
    }
}

void validate_motor(const JointMotor& motor) {
    const int targets = motor.speed.has_value() + motor.position.has_value() + !motor.keys.empty();
    if (targets != 1)
        refuse_joint("motor", targets == 0 ? "no speed, position or keys" : "more than one of speed, position and keys",
                     "either a speed, a position or keys");
    validate_keys(motor.keys);
    const Real target = motor.speed.value_or(motor.position.value_or(0));
    if (!std::isfinite(target)) refuse_joint("motor", short_text(target), "a finite speed or position");
    if (!(std::isfinite(motor.strength) && motor.strength >= 0))
        refuse_joint("motor.strength", short_text(motor.strength), "a maximum torque or force >= 0 (N m or N)");
    if (!(motor.fastest > 0)) refuse_joint("motor.fastest", short_text(motor.fastest), "a speed > 0");
}

void validate_limits(std::optional<Real> lower, std::optional<Real> upper) {
    if (lower && !std::isfinite(*lower)) refuse_joint("lower", short_text(*lower), "a finite number, or no limit");
    if (upper && !std::isfinite(*upper)) refuse_joint("upper", short_text(*upper), "a finite number, or no limit");
    if (lower.value_or(-infinity) > upper.value_or(infinity))
        refuse_joint("lower", short_text(*lower), "a number <= upper, which is " + short_text(*upper));
}

void validate_passive(const JointPassive& passive) {
    const auto require = [](const char* field, Real found, bool good, const char* expected) {
        if (!good || !std::isfinite(found)) refuse_joint(field, short_text(found), expected);
    };
    require("passive.stiffness", passive.stiffness, passive.stiffness >= 0, "a stiffness >= 0 (N m/rad or N/m)");
    require("passive.rest", passive.rest, true, "a finite coordinate (rad or m)");
    require("passive.damping", passive.damping, passive.damping >= 0, "a damping >= 0 (N m s/rad or N s/m)");
    require("passive.friction", passive.friction, passive.friction >= 0, "a moment or force >= 0 (N m or N)");
}

void validate_joint(const JointSettings& joint) {
    require_finite("joint", "point", joint.point);
    require_finite("joint", "axis", joint.axis);
    if (!(joint.axis.norm() > 0)) refuse_joint("axis", "a vector of length 0", "a vector that is not zero");
    if (!std::isfinite(joint.coordinate))
        refuse_joint("coordinate", short_text(joint.coordinate), "a finite coordinate (rad or m)");
    if (has_axis(joint.kind)) {
        if (joint.motor) validate_motor(*joint.motor);
        validate_limits(joint.lower, joint.upper);
        validate_passive(joint.passive);
        return;
    }
    const std::string kind(name_of(joint.kind));
    if (joint.motor) refuse_joint("motor", "a motor on a " + kind + " joint", "a motor on a hinge or slider");
    if (joint.coordinate != 0)
        refuse_joint("coordinate", "a coordinate of a " + kind + " joint", "a coordinate of a hinge or slider");
    if (joint.lower || joint.upper)
        refuse_joint("lower, upper", "limits on a " + kind + " joint", "limits on a hinge or slider");
    if (joint.passive != JointPassive{})
        refuse_joint("passive", "passive forces on a " + kind + " joint", "passive forces on a hinge or slider");
}

JointFrame frame_on(const Model& model, Index body, const Vec3& point, const Mat3& axes) {
    if (body == no_index) return {point, axes};
    const RigidPose pose = pose_of_body(model, static_cast<std::size_t>(body));
    return {pose.rotation.transpose() * (point - pose.position), pose.rotation.transpose() * axes};
}

JointDrive drive_of(const std::optional<JointMotor>& motor) {
    if (!motor) return JointDrive::none;
    const bool has_speed = motor->keys.empty() ? motor->speed.has_value() : motor->keys.front().speed.has_value();
    return has_speed ? JointDrive::speed : JointDrive::position;
}

TimeKey row_of(const MotorKey& key) {
    return {key.time, key.speed.value_or(key.position.value_or(0))};
}

bool has_keys(const JointTable& table, std::size_t joint, const std::optional<JointMotor>& motor) {
    const auto same = [](const TimeKey& a, const MotorKey& b) { return a == row_of(b); };
    const std::span<const MotorKey> keys = motor ? std::span(motor->keys) : std::span<const MotorKey>();
    return std::ranges::equal(table.keys_of(joint), keys, same);
}

void set_keys(JointTable& table, std::size_t joint, const std::optional<JointMotor>& motor) {
    std::vector<TimeKey> keys;
    if (motor)
        for (const MotorKey& key : motor->keys) keys.push_back(row_of(key));
    skerry::set_keys(table.motor_keys, table.key, joint, keys);
}

JointMotorRow row_of(const std::optional<JointMotor>& motor) {
    if (!motor) return {};
    return {motor->speed.value_or(motor->position.value_or(0)), motor->strength, motor->fastest};
}

JointPassiveRow row_of(const JointPassive& passive) {
    return {passive.stiffness, passive.rest, passive.damping, passive.friction};
}

void wake_both(Model& model, std::size_t joint) {
    model.wake(static_cast<std::size_t>(model.joints.first[joint]));
    if (model.joints.second[joint] != no_index) model.wake(static_cast<std::size_t>(model.joints.second[joint]));
}

std::optional<BodyHandle> second_of(const Model& model, std::size_t joint) {
    const Index row = model.joints.second[joint];
    if (row == no_index) return {};
    return handle_of_body(model, row);
}

/// Velocity of a point of a body, and angular velocity of the body. Both are zero for a point of the world.
struct PointVelocity {
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();  // [m/s], [rad/s]
};
PointVelocity velocity_at(const Model& model, Index body, const Vec3& point) {
    if (body == no_index) return {};
    const RigidBodyTable& table = model.rigid_bodies;
    const auto r = static_cast<std::size_t>(model.bodies.rigid[static_cast<std::size_t>(body)].begin);
    const Vec3 turn = spin_of(table.rotation[r], table.moments[r], table.angular_momentum[r]);
    return {table.momentum[r] / table.mass[r] + turn.cross(point - table.center[r]), turn};
}

/// True if another joint of the same two bodies also switches off their collisions. They then stay off when this joint
/// is removed.
bool collisions_off_by_another(const JointTable& table, std::size_t joint) {
    for (std::size_t j = 0; j < table.size(); ++j) {
        const bool same_pair = (table.first[j] == table.first[joint] && table.second[j] == table.second[joint]) ||
                               (table.first[j] == table.second[joint] && table.second[j] == table.first[joint]);
        if (j != joint && same_pair && table.parts[j] != 0) return true;
    }
    return false;
}

/// Coordinate of a joint that mimics another one (its leader), as `ratio` * (coordinate of the head) + `offset`. The
/// head is the last joint of the chain of leaders, since a leader can mimic a further joint.
struct MimicRelation {
    Index head;
    Real ratio = 1, offset = 0;
};
MimicRelation relation_to_head(const JointTable& table, Index joint) {
    MimicRelation relation{joint};
    for (Index leader; (leader = table.leader[static_cast<std::size_t>(relation.head)]) != no_index;
         relation.head = leader) {
        const MimicRow& mimic = table.mimic[static_cast<std::size_t>(relation.head)];
        relation.offset += relation.ratio * mimic.offset;
        relation.ratio *= mimic.ratio;
    }
    return relation;
}

/// Throws SceneError if the joints that mimics couple to `joint` cannot all be within their limits at once. `field`:
/// changed setting of `joint`, for the message. `table`: the joints after the change.
void require_common_position(const JointTable& table, std::size_t joint, const char* field) {
    const MimicRelation own = relation_to_head(table, static_cast<Index>(joint));
    Real lower = -infinity, upper = infinity;  // range of the coordinate of `joint` that satisfies all limits
    for (std::size_t j = 0; j < table.size(); ++j) {
        const MimicRelation other = relation_to_head(table, static_cast<Index>(j));
        if (other.head != own.head) continue;
        const auto in_own = [&](Real limit) { return own.ratio * ((limit - other.offset) / other.ratio) + own.offset; };
        const auto [least, most] = std::minmax({in_own(table.lower[j]), in_own(table.upper[j])});
        lower = std::max(lower, least);
        upper = std::min(upper, most);
    }
    constexpr Real rounding = 1e-9;
    if (lower - upper > rounding * std::max({Real(1), std::abs(lower), std::abs(upper)}))
        refuse_joint(
            field,
            "limits of joints coupled by mimics, which together require a coordinate of this joint of at least " +
                short_text(lower) + " and at most " + short_text(upper),
            "limits that the coupled joints can satisfy together");
}

}  // namespace

JointHandle Joints::add(const JointSettings& joint) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("add_joint");
    Model& model = state.model;
    validate_joint(joint);
    const Index first = rigid_body_of(model, joint.first, "first");
    const Index second = joint.second ? rigid_body_of(model, *joint.second, "second") : no_index;
    if (first == second)
        refuse_joint("second", "the first body of the joint",
                     "another body, or no body to join the first body to the world");
    JointTable& table = model.joints;
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const JointHandle handle = model.joint_map.insert(static_cast<Index>(row));
    const Vec3 axis = joint.axis.normalized();
    const TangentFrame tangents = tangent_frame(axis);
    Mat3 axes;
    axes << tangents.first, tangents.second, axis;
    table.slot[row] = handle.slot;
    table.kind[row] = joint.kind;
    table.drive[row] = drive_of(joint.motor);
    table.first[row] = first;
    table.second[row] = second;
    table.first_frame[row] = frame_on(model, first, joint.point, axes);
    // At coordinate 0 the two frames coincide. The frame on the second body is therefore the frame on the first body,
    // moved back by the coordinate.
    if (joint.kind == JointKind::hinge)
        table.second_frame[row] =
            frame_on(model, second, joint.point, Eigen::AngleAxis<Real>(-joint.coordinate, axis) * axes);
    else
        table.second_frame[row] = frame_on(model, second, joint.point - joint.coordinate * axis, axes);
    table.lower[row] = joint.lower.value_or(-infinity);
    table.upper[row] = joint.upper.value_or(infinity);
    table.motor[row] = row_of(joint.motor);
    table.motor_keys[row] = {};
    set_keys(table, row, joint.motor);
    table.passive[row] = row_of(joint.passive);
    table.leader[row] = no_index;
    table.mimic[row] = {};
    table.mimic_impulse[row] = 0;
    table.coordinate[row] = table.first_coordinate[row] = joint.coordinate;
    table.step[row] = 0;
    table.axis_impulse[row] = {};
    table.impulse[row] = table.moment[row] = Vec3::Zero();
    table.impulse_axes[row] = Mat3::Identity();
    table.parts[row] = 0;
    if (second != no_index && !joint.bodies_touch) {
        table.parts[row] = world_->may_collide(joint.first, *joint.second) || collisions_off_by_another(table, row);
        world_->set_collision(joint.first, *joint.second, false);
    }
    wake_both(model, row);
    model.links_open = true;
    return handle;
}

void prepare_removal(World& world, JointHandle joint) {
    const Model& model = WorldAccess::state_of(world).model;
    const auto row = static_cast<std::size_t>(model.joint_map.row(joint));
    if (model.joints.parts[row] != 0 && !collisions_off_by_another(model.joints, row))
        world.set_collision(handle_of_body(model, model.joints.first[row]), *second_of(model, row), true);
}

JointState Joints::state(JointHandle joint) const {
    return joint_state(WorldAccess::state_of(*world_).model, joint);
}

JointState joint_state(const Model& model, JointHandle joint) {
    const auto j = static_cast<std::size_t>(model.row(joint, "joint"));
    const JointInputs joints = JointInputs::bind({}, model.joints, model.bodies, model.rigid_bodies, model.any_asleep);
    const JointPose first = joints.place(joints.first[j], joints.first_frame[j]),
                    second = joints.place(joints.second[j], joints.second_frame[j]);
    JointState now;
    now.kind = joints.kind[j];
    now.first = handle_of_body(model, model.joints.first[j]);
    now.second = second_of(model, j);
    now.point = first.point;
    now.axis = second.axes.col(2);
    now.coordinate = joint_coordinate(now.kind, first, second, joints.coordinate[j]);
    const PointVelocity of_first = velocity_at(model, joints.first[j], first.point),
                        of_second = velocity_at(model, joints.second[j], first.point);
    if (now.kind == JointKind::hinge) now.speed = now.axis.dot(of_first.spin - of_second.spin);
    if (now.kind == JointKind::slider) now.speed = now.axis.dot(of_first.velocity - of_second.velocity);
    Vec3 separation = first.point - second.point;
    if (now.kind == JointKind::slider) separation -= now.axis.dot(separation) * now.axis;
    now.error = separation.norm();
    if (!(joints.step[j] > 0)) return now;
    const Mat3& axes = model.joints.impulse_axes[j];
    now.force = axes * joints.impulse[j] / joints.step[j];
    now.moment = axes * joints.moment[j] / joints.step[j];
    if (!has_axis(now.kind)) return now;
    const Vec3& along = now.kind == JointKind::hinge ? joints.moment[j] : joints.impulse[j];
    const AxisImpulses& parts = model.joints.axis_impulse[j];
    now.motor = parts.motor / joints.step[j];
    now.passive = parts.passive / joints.step[j];
    now.mimic = joints.mimic_impulse[j] / joints.step[j];
    now.limit = (along.z() - parts.motor - parts.passive) / joints.step[j];
    return now;
}

void Joints::set_motor(JointHandle joint, const std::optional<JointMotor>& motor) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_motor");
    Model& model = state.model;
    const auto row = static_cast<std::size_t>(model.row(joint, "set_motor"));
    if (!has_axis(model.joints.kind[row]))
        refuse_joint("motor", "a motor on a " + std::string(name_of(model.joints.kind[row])) + " joint",
                     "a motor on a hinge or slider");
    if (motor) validate_motor(*motor);
    const JointMotorRow new_row = row_of(motor);
    if (model.joints.drive[row] == drive_of(motor) && model.joints.motor[row] == new_row &&
        has_keys(model.joints, row, motor))
        return;
    set_keys(model.joints, row, motor);
    model.joints.drive[row] = drive_of(motor);
    model.joints.motor[row] = new_row;
    wake_both(model, row);
}

void Joints::set_limits(JointHandle joint, std::optional<Real> lower, std::optional<Real> upper) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_limits");
    Model& model = state.model;
    const auto row = static_cast<std::size_t>(model.row(joint, "set_limits"));
    if (!has_axis(model.joints.kind[row]))
        refuse_joint("lower, upper", "limits on a " + std::string(name_of(model.joints.kind[row])) + " joint",
                     "limits on a hinge or slider");
    validate_limits(lower, upper);
    const Real least = lower.value_or(-infinity), most = upper.value_or(infinity);
    if (model.joints.lower[row] == least && model.joints.upper[row] == most) return;
    JointTable changed = model.joints;
    changed.lower[row] = least;
    changed.upper[row] = most;
    require_common_position(changed, row, "lower, upper");
    model.joints = std::move(changed);
    wake_both(model, row);
}

void Joints::set_passive(JointHandle joint, const JointPassive& passive) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_passive");
    Model& model = state.model;
    const auto row = static_cast<std::size_t>(model.row(joint, "set_passive"));
    if (!has_axis(model.joints.kind[row]))
        refuse_joint("passive", "passive forces on a " + std::string(name_of(model.joints.kind[row])) + " joint",
                     "passive forces on a hinge or slider");
    validate_passive(passive);
    if (model.joints.passive[row] == row_of(passive)) return;
    model.joints.passive[row] = row_of(passive);
    wake_both(model, row);
}

void Joints::set_mimic(JointHandle joint, const std::optional<JointMimic>& mimic) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_mimic");
    Model& model = state.model;
    JointTable& table = model.joints;
    const auto row = static_cast<std::size_t>(model.row(joint, "set_mimic"));
    if (this->mimic(joint) == mimic) return;
    Index leader = no_index;
    if (mimic) {
        leader = model.row(mimic->leader, "set_mimic");
        for (const std::size_t joint_row : {row, static_cast<std::size_t>(leader)})
            if (!has_axis(table.kind[joint_row]))
                refuse_joint("mimic",
                             "a " + std::string(name_of(table.kind[joint_row])) + " joint as the " +
                                 (joint_row == row ? "joint that mimics" : "leader"),
                             "a hinge or a slider");
        if (!std::isfinite(mimic->ratio) || mimic->ratio == 0)
            refuse_joint("mimic.ratio", short_text(mimic->ratio), "a finite number that is not 0");
        if (!std::isfinite(mimic->offset))
            refuse_joint("mimic.offset", short_text(mimic->offset), "a finite coordinate (rad or m)");
        for (Index at = leader; at != no_index; at = table.leader[static_cast<std::size_t>(at)])
            if (at == static_cast<Index>(row))
                refuse_joint(
                    "mimic",
                    leader == at ? "this joint itself" : "a joint that mimics this joint, directly or through others",
                    "another joint, which does not mimic this one");
    }
    JointTable changed = table;
    changed.leader[row] = leader;
    changed.mimic[row] = mimic ? MimicRow{mimic->ratio, mimic->offset} : MimicRow{};
    changed.mimic_impulse[row] = 0;
    require_common_position(changed, row, "mimic");
    table = std::move(changed);
    wake_both(model, row);
    if (leader != no_index) wake_both(model, static_cast<std::size_t>(leader));
    model.links_open = true;
}

std::optional<JointMimic> Joints::mimic(JointHandle joint) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const auto row = static_cast<std::size_t>(model.row(joint, "mimic"));
    const Index leader = model.joints.leader[row];
    if (leader == no_index) return {};
    return JointMimic{model.joint_map.handle_of_slot(model.joints.slot[static_cast<std::size_t>(leader)]),
                      model.joints.mimic[row].ratio, model.joints.mimic[row].offset};
}

std::optional<JointMotor> Joints::motor(JointHandle joint) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const auto row = static_cast<std::size_t>(model.row(joint, "motor"));
    const JointDrive drive = model.joints.drive[row];
    if (drive == JointDrive::none) return {};
    const JointMotorRow& now = model.joints.motor[row];
    JointMotor motor{.strength = now.most, .fastest = now.most_speed};
    const auto target = [drive](Real value) {
        return drive == JointDrive::speed ? MotorKey{.speed = value} : MotorKey{.position = value};
    };
    for (const TimeKey& key : model.joints.keys_of(row)) {
        motor.keys.push_back(target(key.value));
        motor.keys.back().time = key.time;
    }
    if (motor.keys.empty()) {
        motor.speed = target(now.target).speed;
        motor.position = target(now.target).position;
    }
    return motor;
}

JointLimits Joints::limits(JointHandle joint) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const auto row = static_cast<std::size_t>(model.row(joint, "limits"));
    JointLimits limits;
    if (model.joints.lower[row] != -infinity) limits.lower = model.joints.lower[row];
    if (model.joints.upper[row] != infinity) limits.upper = model.joints.upper[row];
    return limits;
}

JointSettings Joints::settings(JointHandle joint) const {
    const JointState now = state(joint);
    const JointLimits range = limits(joint);
    return {.kind = now.kind,
            .first = now.first,
            .second = now.second,
            .point = now.point,
            .axis = now.axis,
            .coordinate = now.coordinate,
            .lower = range.lower,
            .upper = range.upper,
            .motor = motor(joint),
            .passive = passive(joint),
            .bodies_touch = now.second && world_->may_collide(now.first, *now.second)};
}

JointPassive Joints::passive(JointHandle joint) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const JointPassiveRow& row = model.joints.passive[static_cast<std::size_t>(model.row(joint, "passive"))];
    return {row.stiffness, row.rest, row.damping, row.friction};
}

}  // namespace skerry
