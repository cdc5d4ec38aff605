// Elastic forces of the tetrahedra (methods.md 5).
#pragma once

#include <span>

#include "components/element_table.h"
#include "components/material_table.h"
#include "components/step_levels.h"
#include "jobs/executor.h"

namespace skerry {

struct ElementInputs {
    std::span<const ElementNodes> node;
    std::span<const ElementRest> inverse_rest;
    std::span<const ElementLane> volume;
    std::span<const Index> material;
    std::span<const MaterialConstants> constants;
    std::span<const Real> viscous_time = {};  // s; empty: nothing is viscous
    ElementSchedule schedule = {};
};

/// force[block][lane][a]: N, on corner a of each element, from the first Piola-Kirchhoff stress P(F), F = Ds B:
/// (f1 f2 f3) = -V P B^T, f0 = -(f1 + f2 + f3). Corotational elements start the extraction of their frame from `rotation` and leave the
/// result in `rotation_next`; those of other models copy nothing. Blocks that are not due keep what they had; those that are due for
/// several steps at once get so many times the force. Parallel over blocks of lanes.
void compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, std::span<const ElementRotation> rotation,
                            std::span<ElementRotation> rotation_next, std::span<ElementForces> force);

}  // namespace skerry
