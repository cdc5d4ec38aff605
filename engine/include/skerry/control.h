// Types for the live control of a running world between two calls of World::advance (docs/control.md).
#pragma once

#include <cstdint>
#include <optional>

#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Position and orientation of a collider, an attachment or a body.
struct Pose {
    Vec3 position = Vec3::Zero();  // position of the origin of the object's frame in the world [m]
    Vec3 rotation = Vec3::Zero();  // rotation axis times angle [rad]
};

/// Velocities of a rigid motion.
struct Twist {
    // velocity of the centre of mass (body) or of Pose::position (collider, attachment) [m/s]
    Vec3 velocity = Vec3::Zero();
    Vec3 angular_velocity = Vec3::Zero();  // [rad/s]
};

/// Collision groups of an object, and groups that it can touch, both as bits. See BodySettings::collision_group.
struct CollisionGroups {
    std::uint32_t group = 0;  // groups of the object
    std::uint32_t mask = 0;   // groups that it can touch
};

/// Friction and restitution of a body, a collider, a pair of materials or a surface set. A value that is not given is
/// taken from elsewhere:
/// - body: from its material
/// - collider: from its material (SurfacePairs::set_material) or, without a material, from the body that touches it
/// - pair of materials: from the two objects (see MaterialPair)
/// - surface set: from its body
struct SurfaceSettings {
    // Coulomb's friction coefficient, >= 0; default value of static_friction and dynamic_friction
    std::optional<Real> friction{};
    std::optional<Real> static_friction{};   // friction coefficient of sticking contacts, >= dynamic_friction
    std::optional<Real> dynamic_friction{};  // friction coefficient of sliding contacts, >= 0
    std::optional<Real> restitution{};       // rebound speed over impact speed, from 0 to 1
};

}  // namespace skerry
#pragma GCC visibility pop
