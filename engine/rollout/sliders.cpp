#include <algorithm>
#include <array>
#include <cmath>

#include "components/key_lists.h"
#include "engine/base/complaint.h"
#include "engine/rollout/controls.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/objects.h"
#include "engine/world/validate.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Unit of the quantity that a control sets. unit_of() is not called for a PoseControl; the operator for it exists only
/// because std::visit() needs one.
struct UnitOfControl {
    const Model& model;

    std::string operator()(const PoseControl&) const { return "m"; }
    std::string operator()(const MotorSpeedControl& control) const {
        return (*this)(MotorPositionControl{control.joint}) + "/s";
    }
    std::string operator()(const MotorPositionControl& control) const {
        return model.joints.kind[row(control.joint)] == JointKind::hinge ? "rad" : "m";
    }
    std::string operator()(const ValueControl& control) const { return std::visit(*this, control.object); }
    std::string operator()(CableHandle cable) const {
        constexpr std::array units{"N", "m", "m/s"};  // units in the order of CableControl
        return units[static_cast<std::size_t>(model.cables.control[row(cable)])];
    }
    std::string operator()(CavityHandle cavity) const {
        const CavityLaw law = model.cavities.law[row(cavity)];
        return law == CavityLaw::pressure ? "Pa" : law == CavityLaw::gas ? "kg/s" : "m^3";
    }
    std::string operator()(PipeHandle) const { return "Pa"; }
    std::string operator()(SpringHandle) const { return "m"; }
    std::string operator()(LoadHandle) const { return "1"; }
    std::string operator()(FibreHandle) const { return "Pa"; }

private:
    std::size_t row(auto handle) const { return static_cast<std::size_t>(model.row(handle, "slider")); }
};

/// Kind of target of a motor: speed or position. Throws SceneError for a joint without motor.
JointDrive motor_drive(const Model& model, JointHandle joint) {
    const JointDrive drive = model.joints.drive[static_cast<std::size_t>(model.row(joint, "slider"))];
    if (drive == JointDrive::none)
        refuse("joint '" + object_name(model, joint) + "'", "motor", "no motor", "a joint with a motor");
    return drive;
}

/// Present time course of the quantity that a control sets. course_of() is not called for a PoseControl; the operator
/// for it exists only because std::visit() needs one.
struct CourseOfControl {
    const Model& model;

    TimeTable operator()(const PoseControl&) const { return 0; }
    TimeTable operator()(const MotorSpeedControl& control) const { return (*this)(control.joint); }
    TimeTable operator()(const MotorPositionControl& control) const { return (*this)(control.joint); }
    TimeTable operator()(const ValueControl& control) const { return std::visit(*this, control.object); }
    template <class HandleType>
    TimeTable operator()(HandleType object) const {
        const auto row = static_cast<std::size_t>(model.row(object, "slider"));
        const std::span<const TimeKey> keys = ObjectsOf<HandleType>::table(model).keys_of(row);
        if (!keys.empty()) return time_table_of(keys);
        if constexpr (std::is_same_v<HandleType, JointHandle>) {
            (void)motor_drive(model, object);
            return model.joints.motor[row].target;
        }
        refuse("pipe '" + object_name(model, object) + "'", "pressure", "a pipe between two cavities",
               "a pipe between a cavity and a reservoir");
    }
};

Pose pose_at(const Slider& slider, const Pose& start, Real value) {
    return {start.position + value * slider.along,
            slider.about.isZero(0)
                ? start.rotation
                : rotation_vector(rotation_matrix(value * slider.about) * rotation_matrix(start.rotation))};
}

Real value_of(const World& world, const Slider& slider, const SliderTarget& target) {
    const auto* const control = std::get_if<PoseControl>(&target.control);
    if (!control) return value_at(course_of(world, target.control).keys, world.time());
    const MotionKey now = std::visit([&](auto object) { return world.pose(object); }, control->object);
    const Mat3 rotation = rotation_matrix(now.rotation) * rotation_matrix(target.start.rotation).transpose();
    return slider.along.dot(now.position - target.start.position) + slider.about.dot(rotation_vector(rotation));
}

/// Drives one target of a slider so that the value of the slider follows `values`. After the last time of `values` the
/// last value stays.
struct FollowCourse {
    World& world;
    const Slider& slider;
    const SliderTarget& target;
    const TimeTable& values;

    void operator()(const PoseControl& control) const {
        const TimeKey &first = values.keys.front(), &last = values.keys.back();
        const auto key_at = [&](Real time, Real value) {
            const Pose pose = pose_at(slider, target.start, value);
            return Keyframe{time, pose.position, pose.rotation};
        };
        // A motion between two poses must turn by less than half a revolution. With a key halfway the motion may turn
        // by up to a revolution, which is the largest range of a slider.
        const std::array keys{key_at((first.time + last.time) / 2, (first.value + last.value) / 2),
                              key_at(last.time, last.value)};
        std::visit([&](auto object) { follow_poses(world, object, keys); }, control.object);
    }
    void operator()(const MotorSpeedControl& control) const {
        JointMotor motor;
        for (const TimeKey& key : values.keys) motor.keys.push_back({.time = key.time, .speed = key.value});
        set_motor_target(world, control.joint, motor);
    }
    void operator()(const MotorPositionControl& control) const {
        JointMotor motor;
        for (const TimeKey& key : values.keys) motor.keys.push_back({.time = key.time, .position = key.value});
        set_motor_target(world, control.joint, motor);
    }
    void operator()(const ValueControl& control) const { set_controlled_value(world, control, values); }
};

}  // namespace

SliderControl motor_control(const World& world, JointHandle joint) {
    if (motor_drive(WorldAccess::state_of(world).model, joint) == JointDrive::speed) return MotorSpeedControl{joint};
    return MotorPositionControl{joint};
}

std::string unit_of(const World& world, const SliderControl& control) {
    return std::visit(UnitOfControl{WorldAccess::state_of(world).model}, control);
}

TimeTable course_of(const World& world, const SliderControl& control) {
    return std::visit(CourseOfControl{WorldAccess::state_of(world).model}, control);
}

Real slider_value(const World& world, const Slider& slider) {
    return value_of(world, slider, slider.targets.front());
}

void set_slider(World& world, const Slider& slider, Real value) {
    if (!(slider.low <= value && value <= slider.high))
        refuse("slider '" + slider.name + "'", "value", short_text(value),
               "a value from " + short_text(slider.low) + " to " + short_text(slider.high) + " " + slider.unit);
    Real duration = 1e-3;  // least duration, so that the times of the two keys differ also for tiny changes [s]
    for (const SliderTarget& target : slider.targets)  // value_of() refuses removed objects before any object changes
        duration = std::max(duration, std::abs(value - value_of(world, slider, target)) / slider.fastest);
    const Real now = world.time();
    for (const SliderTarget& target : slider.targets) {
        const TimeTable values({{now, value_of(world, slider, target)}, {now + duration, value}});
        std::visit(FollowCourse{world, slider, target, values}, target.control);
    }
}

void start_target(World& world, const Slider& slider, const SliderTarget& target, Real value) {
    if (const auto* const control = std::get_if<PoseControl>(&target.control)) {
        const Pose pose = pose_at(slider, target.start, value);
        std::visit([&](auto object) { world.set_pose(object, pose); }, control->object);
    } else {
        std::visit(FollowCourse{world, slider, target, value}, target.control);
    }
}

}  // namespace skerry
