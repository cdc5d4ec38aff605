// Measures the energy that the viscosity of implicit elements dissipates (docs/methods/clusters.md 2).
#pragma once

#include <span>

#include "components/element_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Energy that the viscosity of implicit elements dissipates in a step [J]. Elements that are left out of the step do
/// not count. Parallel over patches, summed in a fixed order.
///
/// Each element dissipates the product of its viscous impulse and the mean of two rates of F, at `velocity` and at
/// `velocity_next`. The mean is needed because the highest modes change velocities strongly within a step.
/// - `impulse`: viscous impulse of each element (volume times viscous stress times time). `viscous`: 1 for a block with
///   viscous impulses. compute_element_forces wrote both columns.
/// - `patches`: blocks of each patch. `partial`: work memory.
Real measure_viscosity(Executor& executor, const ElementInputs& elements, std::span<const Range> patches,
                       std::span<const ElementViscousImpulse> impulse, std::span<const std::uint8_t> viscous,
                       std::span<const Vec3> velocity, std::span<const Vec3> velocity_next, Column<Real>& partial);

}  // namespace skerry
