// Energy dissipated by the viscosity of implicit elements (docs/methods/clusters.md 2).
#pragma once

#include <span>

#include "components/element_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Energy dissipated by the viscous impulses of the elements that are not left out [J]: impulse times the mean of the
/// rates of F before and after the step. The mean matters because the highest modes change velocities by much within a
/// step. `impulse` and `viscous` are those that compute_element_forces wrote. `patches`: blocks of each patch. Parallel
/// over patches, summed in order.
Real measure_viscosity(Executor& executor, const ElementInputs& elements, std::span<const Range> patches,
                       std::span<const ElementViscousImpulse> impulse, std::span<const std::uint8_t> viscous,
                       std::span<const Vec3> velocity, std::span<const Vec3> velocity_next, Column<Real>& partial);

}  // namespace skerry
