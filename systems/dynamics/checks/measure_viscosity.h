// What viscosity takes of fine elements among coarse (docs/methods/stable_step.md 7.4) and of implicit ones
// (docs/methods/clusters.md 2).
#pragma once

#include <span>

#include "components/element_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// J, of the elements that are due: their viscous impulses times the rate of F, the mean of that before and after the
/// step, as velocities change by much within a step of the highest modes. `impulse` and `viscous` as
/// compute_element_forces left them. `patches`: their blocks. Parallel over patches, summed up in their order.
Real measure_viscosity(Executor& executor, const ElementInputs& elements, std::span<const Range> patches,
                       std::span<const ElementViscousImpulse> impulse, std::span<const std::uint8_t> viscous,
                       std::span<const Vec3> velocity, std::span<const Vec3> velocity_next, Column<Real>& partial);

}  // namespace skerry
