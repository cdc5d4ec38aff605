// The drift; commits the step.
#pragma once

#include <span>

#include "components/options.h"
#include "components/resting_nodes.h"
#include "jobs/executor.h"

namespace skerry {

/// position += h (velocity_next + push_out); velocity = velocity_next; push_out = 0. Forward Euler (literal) drifts with the velocity before
/// the step instead. Nodes at rest are passed over. Parallel over nodes.
void advance_positions(Executor& executor, std::span<const Vec3> velocity_next, Real h, Integrator integrator, const RestingNodes& resting,
                       std::span<Vec3> push_out, std::span<Vec3> position, std::span<Vec3> velocity);

}  // namespace skerry
