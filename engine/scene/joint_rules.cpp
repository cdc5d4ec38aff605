// Keys of joints in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<MotorEntry>& rule_of<MotorEntry>() {
    static const auto rule =
        Rule<MotorEntry>("motor", "A motor on the axis of a hinge (rad, N m) or slider (m, N).")
            .key("speed", &MotorEntry::speed, {.meaning = "target speed", .unit = "rad/s or m/s"})
            .key("position", &MotorEntry::position, {.meaning = "target position", .unit = "rad or m"})
            .key("strength", &MotorEntry::strength,
                 {.meaning = "largest torque or force", .unit = "N m or N", .limits = at_least(0), .required = true})
            .key("fastest", &MotorEntry::fastest,
                 {.meaning = "largest speed on the way to a position; unlimited by default",
                  .unit = "rad/s or m/s",
                  .limits = above(0)})
            .exactly_one({"speed", "position"});
    return rule;
}

template <>
const Rule<JointEntry>& rule_of<JointEntry>() {
    using Entry = JointEntry;
    static const auto rule =
        Rule<Entry>("joint",
                    "A joint between two rigid bodies, or a rigid body and the world, in their poses at the start.")
            .key("kind", &Entry::kind,
                 {.meaning = "free motion of the joint. ball: all rotations; hinge: rotation about the axis; slider: "
                             "translation along the axis; fixed: none",
                  .required = true})
            .key("first", &Entry::first, {.meaning = "name of a rigid body", .required = true})
            .key("second", &Entry::second, {.meaning = "name of another rigid body; the world by default"})
            .key("point", &Entry::point, {.meaning = "position of the joint", .unit = "m"})
            .key("axis", &Entry::axis, {.meaning = "axis of a hinge or slider, of any nonzero length; z by default"})
            .key("lower", &Entry::lower,
                 {.meaning = "lower limit of the rotation or translation; none by default", .unit = "rad or m"})
            .key("upper", &Entry::upper,
                 {.meaning = "upper limit of the rotation or translation; none by default", .unit = "rad or m"})
            .key("motor", &Entry::motor, {.meaning = "motor on the axis; none by default"})
            .key("bodies_touch", &Entry::bodies_touch,
                 {.meaning = "whether the two bodies can touch each other; false by default"});
    return rule;
}

}  // namespace skerry
