// Controls of a rollout: their checks, and their effect on a world.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "jobs/function_ref.h"
#include "skerry/joint.h"
#include "skerry/rollout.h"
#include "skerry/slider.h"
#include "skerry/time_table.h"

namespace skerry {

/// Sets the quantity that a control drives, such as the rest length of a spring, to the time table `value`.
void set_controlled_value(World& world, const ValueControl& control, const TimeTable& value);
/// Gives the motor of a joint the speed, the position or the keys of `target`. Strength and largest speed of the motor
/// stay unchanged; those of `target` are ignored.
void set_motor_target(World& world, JointHandle joint, JointMotor target);

/// MotorSpeedControl of a joint whose motor now has a target speed, otherwise MotorPositionControl. Throws SceneError
/// if the joint has no motor.
SliderControl motor_control(const World& world, JointHandle joint);
/// SI unit of the quantity that a control sets. The control must not be a PoseControl: its unit, m or rad, depends on
/// the slider.
std::string unit_of(const World& world, const SliderControl& control);
/// Present time course of the quantity that a control sets. The control must not be a PoseControl. Throws SceneError
/// for a pipe between two cavities and for a joint without motor.
TimeTable course_of(const World& world, const SliderControl& control);
/// Applies `value` of a slider to one of its targets at once; set_slider() changes the targets gradually.
void start_target(World& world, const Slider& slider, const SliderTarget& target, Real value);
/// Number of values that a control has per interval. Throws SceneError if the world lacks the controlled object, or if
/// the object is a joint without motor.
std::size_t number_count(const World& world, const RolloutControl& control);
/// Returns count_in(world), which must be equal for all worlds. Throws SceneError that names a world if its number
/// differs from that of the first world, or if count_in() throws SceneError for it. `title`: name of the number in
/// messages.
std::size_t agreed_count(std::span<const World* const> worlds, const std::string& title,
                         FunctionRef<std::size_t(const World&)> count_in);
/// Checks that the values of all controls are finite and have the right number, and that no object has two controls.
/// `worlds`: at least one world.
void check_controls(std::span<const World* const> worlds, const RolloutSettings& settings);
/// Applies the values of all controls for one interval to `world`. `number`: index of the world in the rollout.
/// `counts`: number of values of each control per interval. `forces`: scratch memory. Throws SceneError that names the
/// control.
void apply_controls(const RolloutSettings& settings, std::span<const std::size_t> counts, std::size_t number,
                    std::size_t interval, std::vector<Vec3>& forces, World& world);

}  // namespace skerry
