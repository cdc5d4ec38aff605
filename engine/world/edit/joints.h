// Removal of joints, and velocities of points of bodies.
#pragma once

#include <cstdint>
#include <span>

#include "engine/world/state/model.h"

namespace skerry {

/// Removes the marked rows from the table. No handle names them any more.
void erase_joints(std::span<const std::uint8_t> gone, Model& model);

/// Removes the joints of a body that will be removed, and wakes the bodies joined to it.
void erase_joints_of(std::size_t body, Model& model);

/// Motion of a point that moves with a body; zero for the world (`body` is no_index).
struct PointVelocity {
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();  // m/s, rad/s
};
PointVelocity velocity_at(const Model& model, Index body, const Vec3& point);

}  // namespace skerry
