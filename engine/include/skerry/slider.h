// Sliders: values of a scene that a user changes while the scene runs (docs/view.md).
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "skerry/rollout.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Controls whose value a slider can set.
using SliderControl = std::variant<PoseControl, MotorSpeedControl, MotorPositionControl, ValueControl>;

/// An object that a slider moves or drives.
struct SliderTarget {
    SliderControl control;  // the driven object
    Pose start{};           // for a PoseControl: pose of the object at the value 0
};

/// A value within bounds that drives one object, or several objects in the same way. A slider can also be used with
/// clones of the world, because its handles name the same objects there. Meaning of the value:
/// - PoseControl: a displacement in the direction `along` [m], or an angle about the axis `about` through the origin of
///   the object's frame [rad].
/// - Other controls: the value that the control sets.
struct Slider {
    std::string name;                     // unique in its scene
    std::string unit;                     // SI unit of the value; 1 for factors
    Real low = 0, high = 0;               // bounds of the value, low < high
    Real fastest = 0;                     // greatest rate of change of the value, > 0 [`unit` per s]
    Vec3 along = Vec3::Zero();            // direction of the displacement: unit vector in the world, or zero
    Vec3 about = Vec3::Zero();            // axis of the rotation: unit vector in the world, or zero
    std::vector<SliderTarget> targets{};  // at least one
};

/// Present value of a slider, read from the first of its objects. Throws SceneError if this object was removed.
Real slider_value(const World& world, const Slider& slider);
/// Sets the target of a slider. During the next calls of advance, the value of the slider changes to `value` at the
/// constant rate Slider::fastest. Throws SceneError if `value` is out of bounds or an object was removed.
void set_slider(World& world, const Slider& slider, Real value);

}  // namespace skerry
#pragma GCC visibility pop
