// Keys of joints in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<MotorEntry>& rule_of<MotorEntry>() {
    static const auto rule =
        Rule<MotorEntry>("motor",
                         "What drives the axis of a hinge or slider: a hinge in rad and N m, a slider in m and N.")
            .key("speed", &MotorEntry::speed, {.meaning = "the speed that it goes at", .unit = "rad/s or m/s"})
            .key("position", &MotorEntry::position, {.meaning = "where it goes and stays", .unit = "rad or m"})
            .key("strength", &MotorEntry::strength,
                 {.meaning = "the most that it exerts", .unit = "N m or N", .limits = at_least(0), .required = true})
            .key("fastest", &MotorEntry::fastest,
                 {.meaning = "on the way to a position; any speed by default",
                  .unit = "rad/s or m/s",
                  .limits = above(0)})
            .exactly_one({"speed", "position"});
    return rule;
}

template <>
const Rule<JointEntry>& rule_of<JointEntry>() {
    using Entry = JointEntry;
    static const auto rule =
        Rule<Entry>("joint", "Joins two rigid bodies, or one and the world, where they are at the start.")
            .key("kind", &Entry::kind,
                 {.meaning = "what it leaves: ball all turns, hinge a turn about the axis, slider the way along it, "
                             "fixed nothing",
                  .required = true})
            .key("first", &Entry::first, {.meaning = "the name of a rigid body", .required = true})
            .key("second", &Entry::second, {.meaning = "the name of another; by default the world"})
            .key("point", &Entry::point, {.meaning = "where it is", .unit = "m"})
            .key("axis", &Entry::axis, {.meaning = "of a hinge or slider, of any length; z by default"})
            .key("lower", &Entry::lower, {.meaning = "how far it goes back, against the axis", .unit = "rad or m"})
            .key("upper", &Entry::upper, {.meaning = "how far it goes", .unit = "rad or m"})
            .key("motor", &Entry::motor, {.meaning = "what drives it; by default nothing"})
            .key("bodies_touch", &Entry::bodies_touch,
                 {.meaning = "whether its two bodies touch each other; false by default"});
    return rule;
}

}  // namespace skerry
