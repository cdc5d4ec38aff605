// Joints of rigid bodies with limits and motors (docs/methods/joints.md).
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "components/handle.h"
#include "components/joint_kind.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

class World;

/// A motor on the axis of a hinge or a slider. Exactly one of `speed` and `position` must be given. The motor reaches
/// and holds this target as far as its strength allows.
struct JointMotor {
    std::optional<Real> speed{};     // target speed [rad/s or m/s]
    std::optional<Real> position{};  // target coordinate, reached within a step if possible [rad or m]
    Real strength = 0;               // largest moment or force, >= 0 [N m or N]
    Real fastest = std::numeric_limits<Real>::infinity();  // largest speed towards `position`, > 0 [rad/s or m/s]
};

/// A joint of two rigid bodies, or of one and the world, in their present poses. Its coordinate is zero there and
/// measures the motion of the first body relative to the second: the angle of a hinge about the axis, with whole turns
/// counted [rad], or the displacement of a slider along the axis [m].
struct JointSettings {
    JointKind kind = JointKind::ball;
    BodyHandle first{};                    // a rigid body
    std::optional<BodyHandle> second{};    // another rigid body; if not given, the world
    Vec3 point = Vec3::Zero();             // position of the joint in the world [m]
    Vec3 axis = {0, 0, 1};                 // axis of a hinge or slider in the world, any length but zero
    std::optional<Real> lower{}, upper{};  // limits of the coordinate, lower <= upper
    std::optional<JointMotor> motor{};
    bool bodies_touch = false;  // false: the two do not collide while the joint exists
};

/// State of a joint. Force and moment are those of the last step on the first body, in world axes.
struct JointState {
    JointKind kind = JointKind::ball;
    BodyHandle first{};
    std::optional<BodyHandle> second{};
    Vec3 point = Vec3::Zero();   // point of the joint on the first body, in the world [m]
    Vec3 axis = {0, 0, 1};       // axis on the second body, in the world
    Real coordinate = 0;         // [rad or m]
    Real speed = 0;              // [rad/s or m/s]
    Vec3 force = Vec3::Zero();   // at `point` [N]
    Vec3 moment = Vec3::Zero();  // [N m]
    Real error = 0;              // distance of the points that should coincide; for a slider, normal to the axis [m]
};

/// The joints of a world: a view, valid until the world is moved or destroyed. As in World, functions that change
/// joints may be called between calls of advance only. They throw SceneError and change nothing if a handle is stale or
/// a value is out of range. Joints are part of the state: saved, cloned and hashed.
class Joints {
public:
    explicit Joints(World& world) : world_(&world) {}

    /// Joins two rigid bodies, or one and the world, in their present poses. The joint is removed with either body.
    JointHandle add(const JointSettings& joint);
    void remove(JointHandle joint);
    bool alive(JointHandle joint) const;
    std::vector<JointHandle> all() const;  // in the order added
    /// Present pose and motion of a joint, and its force and moment in the last step.
    JointState state(JointHandle joint) const;
    /// Sets the motor of a hinge or a slider, or removes it if none is given. Setting the present motor again changes
    /// no bit.
    void set_motor(JointHandle joint, const std::optional<JointMotor>& motor);
    /// Sets or removes the limits of the coordinate. A joint beyond a limit is pulled back at a bounded speed. For a
    /// slider it is recovery_speed plus the speeds at the joint due to the spins of both bodies, for a hinge 1 rad/s
    /// plus both spins.
    void set_limits(JointHandle joint, std::optional<Real> lower, std::optional<Real> upper);

private:
    World* world_;
};

}  // namespace skerry
#pragma GCC visibility pop
