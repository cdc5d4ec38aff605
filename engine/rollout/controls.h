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

/// Sets the value of the object of a control.
void set_controlled_value(World& world, const ValueControl& control, const TimeTable& value);
/// Gives the motor of a joint the speed, the position or the keys of `target`. Its strength and its greatest speed stay
/// unchanged.
void set_motor_target(World& world, JointHandle joint, JointMotor target);

/// Control of the motor of a joint, by its present kind of target. Throws SceneError if the joint has no motor.
SliderControl motor_control(const World& world, JointHandle joint);
/// SI unit of the value that a control sets, which must not be a PoseControl.
std::string unit_of(const World& world, const SliderControl& control);
/// Value that a control sets, over time. The control must not be a PoseControl. Throws SceneError for a pipe without
/// reservoir.
TimeTable course_of(const World& world, const SliderControl& control);
/// Sets a target of a slider to a value at once, without a motion to it.
void start_target(World& world, const Slider& slider, const SliderTarget& target, Real value);
/// Number of values that a control has per interval. Throws SceneError if the world lacks the controlled object, or if
/// the object is a joint without motor.
std::size_t number_count(const World& world, const RolloutControl& control);
/// Returns the number that `count_in` finds in each world. Throws SceneError that names the world if the numbers differ
/// or if `count_in` throws one. `title`: name of the number in messages.
std::size_t agreed_count(std::span<const World* const> worlds, const std::string& title,
                         FunctionRef<std::size_t(const World&)> count_in);
/// Checks number and values of all controls, and that no object has two controls. `worlds`: at least one world.
void check_controls(std::span<const World* const> worlds, const RolloutSettings& settings);
/// Applies the values of all controls for one interval of the world with this number. `counts`: number of values of
/// each control per interval. `forces` is memory that is used again. Throws SceneError that names the control.
void apply_controls(const RolloutSettings& settings, std::span<const std::size_t> counts, std::size_t number,
                    std::size_t interval, std::vector<Vec3>& forces, World& world);

}  // namespace skerry
