// The kick of symplectic Euler.
#pragma once

#include <span>

#include "components/resting_nodes.h"
#include "jobs/executor.h"

namespace skerry {

/// velocity_next = velocity + h force inverse_mass. Nodes without freedom (inverse mass 0) keep their velocity, and
/// those at rest are passed over. Parallel over nodes.
void predict_velocity(Executor& executor, std::span<const Vec3> force, std::span<const Real> inverse_mass, std::span<const Vec3> velocity,
                      Real h, const RestingNodes& resting, std::span<Vec3> velocity_next);

}  // namespace skerry
