// Elastic forces of the tetrahedra (docs/methods/elasticity.md 1).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/material_table.h"
#include "components/step_levels.h"
#include "jobs/access.h"
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

    /// `any_asleep`: some body rests. Without it and `active`: all elements, whether they are active in this step or
    /// not.
    static ElementInputs bind(const Binder& binder, const ElementBlockTable& element, const MaterialTable& material,
                              const BodyTable& body, const ActiveLevels& active = {}, const bool& any_asleep = false) {
        return {.node = binder.read(element.node),
                .inverse_rest = binder.read(element.inverse_rest),
                .volume = binder.read(element.volume),
                .material = binder.read(element.material),
                .constants = binder.read(material.constants),
                .viscous_time = binder.read(element.viscous_time),
                .schedule = {.level = binder.read(element.level),
                             .body = binder.read(element.body),
                             .body_level = binder.read(body.level),
                             .active = binder.value(active),
                             .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep)}};
    }
};

/// force[block][lane][a]: N, on corner a of each element, from the first Piola-Kirchhoff stress P(F), F = Ds B:
/// (f1 f2 f3) = -V P B^T, f0 = -(f1 + f2 + f3). Corotational elements start the extraction of their frame from
/// `rotation` and leave the result in `rotation_next`; those of other models copy nothing. Blocks that are not active
/// keep what they had; those that are active for several steps at once get so many times the force. Parallel over
/// blocks of lanes.
void compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, std::span<const ElementRotation> rotation,
                            std::span<ElementRotation> rotation_next, std::span<ElementForces> force);

}  // namespace skerry
