// Keys of joints in a scene file.
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<MotorKey>& rule_of<MotorKey>() {
    static const auto rule =
        Rule<MotorKey>("motor_key", "A target of a motor. Between two keys the target changes linearly.")
            .key("time", &MotorKey::time, {.meaning = "time of the key", .unit = "s", .required = true})
            .key("speed", &MotorKey::speed, {.meaning = "target speed", .unit = "rad/s or m/s"})
            .key("position", &MotorKey::position, {.meaning = "target position", .unit = "rad or m"})
            .exactly_one({"speed", "position"});
    return rule;
}

template <>
const Rule<MotorEntry>& rule_of<MotorEntry>() {
    static const auto rule =
        Rule<MotorEntry>("motor", "A motor on the axis of a hinge (rad, N m) or slider (m, N).")
            .key("speed", &MotorEntry::speed, {.meaning = "target speed", .unit = "rad/s or m/s"})
            .key("position", &MotorEntry::position, {.meaning = "target position", .unit = "rad or m"})
            .key("keys", &MotorEntry::keys,
                 {.meaning = "targets at ascending times, either all of them speeds or all of them positions"})
            .key("strength", &MotorEntry::strength,
                 {.meaning = "largest torque or force", .unit = "N m or N", .limits = at_least(0), .required = true})
            .key("fastest", &MotorEntry::fastest,
                 {.meaning = "largest speed of the motion to the target position; default: unlimited",
                  .unit = "rad/s or m/s",
                  .limits = above(0)})
            .exactly_one({"speed", "position", "keys"});
    return rule;
}

template <>
const Rule<JointPassive>& rule_of<JointPassive>() {
    using Passive = JointPassive;
    static const auto rule =
        Rule<Passive>("passive", "Passive forces along the axis of a hinge (rad, N m) or slider (m, N).")
            .key("stiffness", &Passive::stiffness,
                 {.meaning = "stiffness of a spring", .unit = "N m/rad or N/m", .limits = at_least(0)})
            .key("rest", &Passive::rest,
                 {.meaning = "angle or displacement at which the spring exerts no force", .unit = "rad or m"})
            .key("damping", &Passive::damping,
                 {.meaning = "torque or force per speed", .unit = "N m s/rad or N s/m", .limits = at_least(0)})
            .key("friction", &Passive::friction,
                 {.meaning = "largest torque or force of dry friction", .unit = "N m or N", .limits = at_least(0)});
    return rule;
}

template <>
const Rule<MimicEntry>& rule_of<MimicEntry>() {
    using Mimic = MimicEntry;
    static const auto rule =
        Rule<Mimic>("mimic", "Coupling to another hinge or slider: coordinate = ratio * its coordinate + offset.")
            .key("joint", &Mimic::joint, {.meaning = "name of the other joint", .required = true})
            .key("ratio", &Mimic::ratio, {.meaning = "not 0; between a hinge and a slider in m/rad or rad/m"})
            .key("offset", &Mimic::offset, {.meaning = "coordinate while the other one is 0", .unit = "rad or m"});
    return rule;
}

template <>
const Rule<JointEntry>& rule_of<JointEntry>() {
    using Entry = JointEntry;
    static const auto rule =
        Rule<Entry>("joint",
                    "A joint between two rigid bodies, or between a rigid body and the world. The joint connects them "
                    "in their poses at the start.")
            .key("name", &Entry::name, {.meaning = "name for probes; default: joint_NUMBER"})
            .key("kind", &Entry::kind,
                 {.meaning = "free motion of the joint. ball: all rotations; hinge: rotation about the axis; slider: "
                             "translation along the axis; fixed: none",
                  .required = true})
            .key("first", &Entry::first, {.meaning = "name of a rigid body", .required = true})
            .key("second", &Entry::second, {.meaning = "name of another rigid body; default: the world"})
            .key("point", &Entry::point, {.meaning = "position of the joint in the world", .unit = "m"})
            .key("axis", &Entry::axis,
                 {.meaning = "axis of a hinge or slider in the world, of any nonzero length; default: z"})
            .key("coordinate", &Entry::coordinate,
                 {.meaning = "value of the rotation or translation in the poses at the start; default: 0",
                  .unit = "rad or m"})
            .key("lower", &Entry::lower,
                 {.meaning = "lower limit of the rotation or translation; default: none", .unit = "rad or m"})
            .key("upper", &Entry::upper,
                 {.meaning = "upper limit of the rotation or translation; default: none", .unit = "rad or m"})
            .key("motor", &Entry::motor, {.meaning = "motor on the axis; default: none"})
            .key("passive", &Entry::passive, {.meaning = "spring, damper and dry friction on the axis; default: none"})
            .key("mimic", &Entry::mimic, {.meaning = "another joint that the joint follows; default: none"})
            .key("bodies_touch", &Entry::bodies_touch,
                 {.meaning = "whether the two bodies can touch each other; default: false"});
    return rule;
}

}  // namespace skerry
