// Joints of rigid bodies: what two of them leave to each other, how far, and what drives them (docs/methods/joints.md).
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

/// Drives the axis of a hinge or a slider, as far as its strength goes, and holds it there. Of speed and position one.
struct JointMotor {
    std::optional<Real> speed{};     // rad/s or m/s
    std::optional<Real> position{};  // rad or m, of the coordinate; reached within a step where it can
    Real strength = 0;               // N m or N, >= 0: the most that it exerts
    Real fastest = std::numeric_limits<Real>::infinity();  // rad/s or m/s, > 0: on the way to a position
};

/// A joint where its bodies are now. Its coordinate is how far the first has come from there against the second: the
/// angle of a hinge about the axis (rad, whole turns counted), the way of a slider along it (m).
struct JointSettings {
    JointKind kind = JointKind::ball;
    BodyHandle first{};                    // a rigid body
    std::optional<BodyHandle> second{};    // another; none: the world
    Vec3 point = Vec3::Zero();             // m, world
    Vec3 axis = {0, 0, 1};                 // of a hinge or slider, world, any length but zero
    std::optional<Real> lower{}, upper{};  // of the coordinate: lower <= 0 <= upper
    std::optional<JointMotor> motor{};
    bool bodies_touch = false;  // else contacts of the two are switched off while the joint is there
};

/// What a joint is and does. Forces are those of the last step, on the first body, as the world sees them.
struct JointState {
    JointKind kind = JointKind::ball;
    BodyHandle first{};
    std::optional<BodyHandle> second{};
    Vec3 point = Vec3::Zero();   // m, of the first body
    Vec3 axis = {0, 0, 1};       // of the second
    Real coordinate = 0;         // rad or m
    Real speed = 0;              // rad/s or m/s
    Vec3 force = Vec3::Zero();   // N, at the point
    Vec3 moment = Vec3::Zero();  // N m
    Real error = 0;              // m: how far the points are apart that should be one
};

/// The joints of a world: a view, valid as long as the world is where it is. What changes them is allowed between calls
/// of advance, as in World, and throws SceneError, with nothing changed, for a handle that is stale and for values out
/// of range. They are state: saved, cloned and hashed.
class Joints {
public:
    explicit Joints(World& world) : world_(&world) {}

    /// Joins two rigid bodies, or one and the world, where they are now. Goes with either of its bodies.
    JointHandle add(const JointSettings& joint);
    void remove(JointHandle joint);
    bool alive(JointHandle joint) const;
    std::vector<JointHandle> all() const;  // in the order added
    /// Where it is, and what it gave in the last step.
    JointState state(JointHandle joint) const;
    /// What drives a hinge or a slider from now on; nothing where none is given. A motor that it has already changes no
    /// bit.
    void set_motor(JointHandle joint, const std::optional<JointMotor>& motor);
    /// How far it goes: where it is beyond, it is taken back at its speed and recovery_speed.
    void set_limits(JointHandle joint, std::optional<Real> lower, std::optional<Real> upper);

private:
    World* world_;
};

}  // namespace skerry
#pragma GCC visibility pop
