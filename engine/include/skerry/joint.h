// Joints of rigid bodies with limits and motors (docs/methods/joints.md).
#pragma once

#include <optional>
#include <vector>

#include "components/handle.h"
#include "components/joint_kind.h"
#include "components/types.h"
#include "skerry/object_view.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Key of a motor: a target speed or a target coordinate at an absolute time. Exactly one of the two must be given.
struct MotorKey {
    Real time = 0;                   // absolute time [s]
    std::optional<Real> speed{};     // target speed [rad/s or m/s]
    std::optional<Real> position{};  // target coordinate [rad or m]
};

/// A motor on the axis of a hinge or a slider. Exactly one of `speed`, `position` and `keys` must be given as its
/// target. The motor reaches and holds the target as far as its largest moment or force `strength` allows.
struct JointMotor {
    std::optional<Real> speed{};     // target speed [rad/s or m/s]
    std::optional<Real> position{};  // target coordinate of the joint, reached within one step if possible [rad or m]
    Real strength = 0;               // largest moment (hinge) or force (slider) of the motor, >= 0 [N m or N]
    // Largest speed at which the motor approaches a target coordinate, > 0 [rad/s or m/s].
    Real fastest = infinity;
    // Targets at ascending times, either all of them speeds or all of them positions. The target changes linearly
    // between keys, and is constant before the first and after the last key.
    std::vector<MotorKey> keys{};
};

/// Spring, damper and dry friction on the axis of a joint. They exert a moment on a hinge and a force on a slider. The
/// joint may also have a motor (docs/methods/joints.md 4).
struct JointPassive {
    Real stiffness = 0;  // stiffness of a spring, >= 0 [N m/rad or N/m]
    Real rest = 0;       // coordinate of the joint at which the spring exerts no force [rad or m]
    Real damping = 0;    // moment or force per speed, >= 0 [N m s/rad or N s/m]
    Real friction = 0;   // greatest moment or force of dry friction, >= 0 [N m or N]

    bool operator==(const JointPassive&) const = default;
};

/// Coupling of the coordinate q of a hinge or slider to the coordinate q_leader of another joint, its leader: q = ratio
/// q_leader + offset. The coupling acts in both directions: forces on one joint move the other one.
struct JointMimic {
    JointHandle leader{};  // another hinge or slider; it must not mimic this joint, directly or through other joints
    Real ratio = 1;        // not 0; [m/rad] or [rad/m] between a slider and a hinge
    Real offset = 0;       // coordinate of this joint if that of the leader is 0 [rad or m]

    bool operator==(const JointMimic&) const = default;
};

/// Limits of the coordinate of a joint.
struct JointLimits {
    std::optional<Real> lower{}, upper{};  // a missing value is no limit [rad or m]
};

/// A joint between two rigid bodies, or between a rigid body and the world, in their present poses. Its coordinate
/// measures the motion of the first body relative to the second body or the world:
/// - hinge: angle about the axis, counting full revolutions [rad]
/// - slider: displacement along the axis [m]
struct JointSettings {
    JointKind kind = JointKind::ball;  // relative motion that the joint permits
    BodyHandle first{};                // handle of a rigid body
    // another rigid body; if it is not given, the first body is joined to the world
    std::optional<BodyHandle> second{};
    Vec3 point = Vec3::Zero();             // position of the joint in the world [m]
    Vec3 axis = {0, 0, 1};                 // axis of a hinge or slider in the world; the length must not be zero
    Real coordinate = 0;                   // coordinate of a hinge or slider in the present poses [rad or m]
    std::optional<Real> lower{}, upper{};  // limits of the coordinate, lower <= upper [rad or m]
    std::optional<JointMotor> motor{};     // motor on the axis; default: none
    JointPassive passive{};                // spring, damper and dry friction on the axis
    bool bodies_touch = false;             // true: the two bodies may collide while the joint exists
};

/// State of a joint. Force and moment are those of the last step. They act on the first body and are given in world
/// axes.
struct JointState {
    JointKind kind = JointKind::ball;    // relative motion that the joint permits
    BodyHandle first{};                  // the first body
    std::optional<BodyHandle> second{};  // the second body; missing if the first is joined to the world
    Vec3 point = Vec3::Zero();           // point of the joint on the first body, in world coordinates [m]
    Vec3 axis = {0, 0, 1};               // axis of the joint on the second body, in world coordinates
    Real coordinate = 0;                 // present coordinate, see JointSettings [rad or m]
    Real speed = 0;                      // rate of the coordinate [rad/s or m/s]
    Vec3 force = Vec3::Zero();           // force acting at `point` [N]
    Vec3 moment = Vec3::Zero();          // moment [N m]
    // Parts of the moment (hinge) or force (slider) along the axis [N m or N]: by the motor, by the passive forces
    // (spring, damper and friction together, see JointPassive), and by the limits of the coordinate.
    Real motor = 0, passive = 0, limit = 0;
    // Moment or force along the axis that makes the joint mimic its leader [N m or N]; `force` and `moment` do not
    // contain it. The leader gets -JointMimic::ratio times this moment or force.
    Real mimic = 0;
    // Position error [m]: distance between the points of the two bodies that the joint should keep together. For a
    // slider it is the part of this distance normal to the axis.
    Real error = 0;
};

extern template class __attribute__((visibility("default"))) ObjectView<JointHandle>;

/// A view of the joints of a world.
class Joints : public ObjectView<JointHandle> {
public:
    using ObjectView::ObjectView;

    /// Joins two rigid bodies, or a rigid body and the world, in their present poses. The joint is removed when either
    /// body is removed.
    JointHandle add(const JointSettings& joint);
    /// Returns the present pose and motion of a joint, and the joint's force and moment in the last step.
    JointState state(JointHandle joint) const;
    /// Settings with which add() would make a joint like this one in its present state: point, axis and coordinate have
    /// their present values. The settings do not contain the coupling to a leader; see mimic().
    JointSettings settings(JointHandle joint) const;
    /// Sets the motor of a hinge or a slider, or removes the motor if none is given. Setting a motor equal to the
    /// present one changes no bit of the state.
    void set_motor(JointHandle joint, const std::optional<JointMotor>& motor);
    /// Sets or removes the limits of the joint coordinate. A joint beyond a limit is pulled back at a bounded speed, to
    /// avoid jerks. The upper limit of this speed is
    /// - slider: Settings::recovery_speed, plus the speeds at which the joint point moves around the centres of mass of
    ///   both bodies when they rotate,
    /// - hinge: 1 rad/s plus both angular speeds.
    void set_limits(JointHandle joint, std::optional<Real> lower, std::optional<Real> upper);
    /// Sets spring, damper and friction of a hinge or a slider.
    void set_passive(JointHandle joint, const JointPassive& passive);
    /// Makes a hinge or a slider follow another joint, its leader (JointMimic), or ends the coupling if no mimic is
    /// given. A deviation from the coupling is corrected at the bounded speed that set_limits() describes. Removing the
    /// leader ends the coupling.
    void set_mimic(JointHandle joint, const std::optional<JointMimic>& mimic);
    /// Coupling of a joint to the leader that it mimics; empty if it mimics none.
    std::optional<JointMimic> mimic(JointHandle joint) const;
    /// The motor of a joint; empty if it has none.
    std::optional<JointMotor> motor(JointHandle joint) const;
    /// The limits of the joint coordinate.
    JointLimits limits(JointHandle joint) const;
    /// Spring, damper and friction of a joint.
    JointPassive passive(JointHandle joint) const;
};

}  // namespace skerry
#pragma GCC visibility pop
