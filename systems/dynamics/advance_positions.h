// The drift of symplectic Euler; commits the step.
#pragma once

#include <span>

#include "components/types.h"
#include "jobs/executor.h"

namespace skerry {

/// position += h (velocity_next + push_out); velocity = velocity_next; push_out = 0. Parallel over nodes.
void advance_positions(Executor& executor, std::span<const Vec3> velocity_next, Real h, std::span<Vec3> push_out, std::span<Vec3> position,
                       std::span<Vec3> velocity);

}  // namespace skerry
