// How long steps may be.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/world/kernels.h"
#include "engine/world/step/step.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/clusters/stiffen_clusters.h"
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

Real watch_stable_steps(Model& model, Column<Real>& stiffness_sum) {
    constexpr Real worth_clusters = 1.25;  // steps that a strained body makes shorter by this
    constexpr Real reserve = 1.05;         // so that the next look finds it standing, too
    stiffness_sum.resize(model.nodes.position.size());
    BodyTable& bodies = model.bodies;
    const auto now = [&](std::size_t b) {
        const ElementInputs elements = model.all_elements();
        const Range blocks = bodies.blocks[b];
        Real step = kernels().stable_step(elements, blocks, model.nodes.position, model.nodes.mass, stiffness_sum).step;
        if (bodies.cluster_step[b] > 0) {
            const Real stiffening =
                worst_stiffening(elements, blocks, model.nodes.position,
                                 model.elements.implicit_modulus.span().subspan(
                                     static_cast<std::size_t>(blocks.begin), static_cast<std::size_t>(blocks.size())));
            // not a number where a shape is none
            step = std::min(step, bodies.cluster_step[b] / std::sqrt(stiffening > 1 ? stiffening : Real(1)));
        }
        return step;
    };
    Real goal = std::numeric_limits<Real>::infinity();  // s, what bodies stand when they are not strained
    for (std::size_t b = 0; b < bodies.slot.size(); ++b)
        if (bodies.tetrahedron_count[b] > 0) goal = std::min(goal, bodies.rest_step[b]);
    const Real energy_before = added_energy(model);
    bool changed = false;
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) {
        if (bodies.tetrahedron_count[b] == 0) continue;
        bodies.stable_step[b] = now(b);
        if (!(bodies.stable_step[b] > 0) || bodies.stable_step[b] * worth_clusters >= goal ||
            !clusters_allowed(model.settings))
            continue;
        if (!make_implicit(model, b, reserve * goal, bodies.stable_step[b], stiffness_sum)) continue;
        changed = true;
        bodies.stable_step[b] = now(b);
    }
    if (!changed) return 0;
    model.rebuild_clusters();
    return added_energy(model) - energy_before;
}

Real follow_stiffening(Model& model) {
    if (model.clusters.empty()) return 0;
    return stiffen_clusters(model.all_elements(),
                            {model.bodies.blocks, model.bodies.cluster_step, model.bodies.asleep, model.nodes.position,
                             model.nodes.velocity, model.nodes.inverse_mass},
                            model.elements.implicit_modulus.span(), model.clusters);
}

}  // namespace skerry
