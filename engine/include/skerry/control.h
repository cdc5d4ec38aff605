// Types for the control of a running world, between calls of World::advance (docs/control.md).
#pragma once

#include <optional>

#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Position and orientation of a collider, an attachment or a body.
struct Pose {
    Vec3 position = Vec3::Zero();  // [m]
    Vec3 rotation = Vec3::Zero();  // axis times angle [rad]
};

/// Friction and restitution of one body or collider. A body takes missing values from its material. A collider takes
/// them from the body that touches it.
struct SurfaceSettings {
    std::optional<Real> friction{};          // Coulomb's mu, >= 0: default of the next two
    std::optional<Real> static_friction{};   // >= dynamic_friction
    std::optional<Real> dynamic_friction{};  // >= 0
    std::optional<Real> restitution{};       // in [0, 1]
};

}  // namespace skerry
#pragma GCC visibility pop
