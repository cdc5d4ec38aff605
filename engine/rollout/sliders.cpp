#include <algorithm>
#include <array>
#include <cmath>

#include "components/key_lists.h"
#include "engine/rollout/controls.h"
#include "engine/world/complaint.h"
#include "skerry/slider.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

Pose pose_at(const Slider& slider, const Pose& start, Real value) {
    return {start.position + value * slider.along,
            slider.about.isZero(0)
                ? start.rotation
                : rotation_vector(rotation_matrix(value * slider.about) * rotation_matrix(start.rotation))};
}

JointMotor motor_target(const TimeTable& course, std::optional<Real> MotorKey::*quantity) {
    JointMotor motor;
    for (const TimeKey& key : course.keys) motor.keys.emplace_back(MotorKey{.time = key.time}).*quantity = key.value;
    return motor;
}

/// Lets one target follow a course.
struct FollowCourse {
    World& world;
    const Slider& slider;
    const SliderTarget& target;
    const TimeTable& course;

    void operator()(const PoseControl& control) const {
        constexpr Real shortest = 1e-3;  // duration of a motion by nothing but rounding errors [s]
        const Real duration = std::max(course.keys.back().time - world.time(), shortest);
        const Pose pose = pose_at(slider, target.start, course.keys.back().value);
        std::visit([&](auto object) { world.move_to(object, pose, duration); }, control.object);
    }
    void operator()(const MotorSpeedControl& control) const {
        set_motor_target(world, control.joint, motor_target(course, &MotorKey::speed));
    }
    void operator()(const MotorPositionControl& control) const {
        set_motor_target(world, control.joint, motor_target(course, &MotorKey::position));
    }
    void operator()(const ValueControl& control) const { set_controlled_value(world, control, course); }
};

}  // namespace

Real slider_value(const World& world, const Slider& slider) {
    const SliderTarget& first = slider.targets.front();
    const auto* const control = std::get_if<PoseControl>(&first.what);
    if (!control) return value_at(slider.course.keys, world.time());
    const MotionKey now = std::visit([&](auto object) { return world.pose(object); }, control->object);
    const Mat3 turned = rotation_matrix(now.rotation) * rotation_matrix(first.start.rotation).transpose();
    return slider.along.dot(now.position - first.start.position) + slider.about.dot(rotation_vector(turned));
}

void set_slider(World& world, Slider& slider, Real value) {
    if (!(slider.low <= value && value <= slider.high))
        Complaint{
            .file = {},
            .object = "slider '" + slider.name + "'",
            .field = "value",
            .found = short_text(value),
            .expected = "a value from " + short_text(slider.low) + " to " + short_text(slider.high) + " " + slider.unit,
            .hint = {}}
            .raise();
    for (const SliderTarget& target : slider.targets) {
        RolloutControl control;
        std::visit([&](const auto& what) { control.what = what; }, target.what);
        (void)number_count(world, control);  // refuses an object that was removed before any object is changed
    }
    const Real now = world.time(), from = slider_value(world, slider);
    const TimeTable course = value == from
                                 ? TimeTable(value)
                                 : TimeTable({{now, from}, {now + std::abs(value - from) / slider.fastest, value}});
    for (const SliderTarget& target : slider.targets)
        std::visit(FollowCourse{world, slider, target, course}, target.what);
    slider.course = course;
}

void start_slider(World& world, const Slider& slider) {
    for (const SliderTarget& target : slider.targets)
        if (const auto* const control = std::get_if<PoseControl>(&target.what))
            std::visit(
                [&](auto object) {
                    world.set_pose(object, pose_at(slider, target.start, slider.course.keys.back().value));
                },
                control->object);
        else
            std::visit(FollowCourse{world, slider, target, slider.course}, target.what);
}

}  // namespace skerry
