// What can be set in a world that runs, between calls of World::advance (docs/control.md).
#pragma once

#include <optional>

#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Where a collider or an attachment is.
struct Pose {
    Vec3 position = Vec3::Zero();  // m
    Vec3 rotation = Vec3::Zero();  // rad, axis times angle
};

/// Friction and restitution of one body or collider. What is not given is left to others: of a body to its material, of
/// a collider to the body that touches it.
struct SurfaceSettings {
    std::optional<Real> friction{};          // Coulomb's mu, >= 0; both of the next two unless they are given
    std::optional<Real> static_friction{};   // >= dynamic_friction
    std::optional<Real> dynamic_friction{};  // >= 0
    std::optional<Real> restitution{};       // in [0, 1]
};

}  // namespace skerry
#pragma GCC visibility pop
