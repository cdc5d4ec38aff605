// How long steps may be.
#include <algorithm>
#include <limits>

#include "engine/world/step/step.h"
#include "systems/dynamics/stability/stable_step.h"

namespace skerry {

Real stable_step(const BodyTable& bodies, Index* body) {
    Real smallest = std::numeric_limits<Real>::infinity();
    for (std::size_t b = 0; b < bodies.slot.size(); ++b)
        if (bodies.stable_step[b] < smallest) {
            smallest = bodies.stable_step[b];
            if (body) *body = static_cast<Index>(b);
        }
    return smallest;
}

Real trusted_step(const Model& model, Index* body) {
    const Real stable = stable_step(model.bodies, body) * model.settings.step_safety;
    return std::min(stable, model.settings.step_size.value_or(stable));
}

void watch_stable_steps(Model& model, Column<Real>& stiffness_sum) {
    stiffness_sum.resize(model.nodes.position.size());
    const ElementInputs elements = model.all_elements();
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.tetrahedron_count[b] > 0)
            model.bodies.stable_step[b] =
                stable_step(elements, model.bodies.blocks[b], model.nodes.position, model.nodes.mass, stiffness_sum)
                    .step;
}

}  // namespace skerry
