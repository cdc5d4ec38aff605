// Rows of joints go, and the points of their bodies move.
#pragma once

#include <cstdint>
#include <span>

#include "engine/world/state/model.h"

namespace skerry {

/// Takes the rows that are marked out of the table. No handle names them any more.
void erase_joints(std::span<const std::uint8_t> gone, Model& model);

/// Those of a body, which goes: what it is joined to wakes.
void erase_joints_of(std::size_t body, Model& model);

/// Of a point that moves with a body; zero of the world, `body` no_index.
struct PointVelocity {
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();  // m/s, rad/s
};
PointVelocity velocity_at(const Model& model, Index body, const Vec3& point);

}  // namespace skerry
