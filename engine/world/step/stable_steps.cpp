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

Real look_at_stable_step(const Model& model, std::size_t body, std::span<const Vec3> position,
                         Column<Real>& stiffness_sum) {
    stiffness_sum.resize(position.size());
    const ElementInputs elements = model.all_elements();
    const Range blocks = model.bodies.blocks[body];
    const Real step = kernels().stable_step(elements, blocks, position, model.nodes.mass, stiffness_sum).step;
    const Real of_clusters = model.bodies.cluster_step[body];
    if (!(of_clusters > 0)) return step;
    const Real stiffening =
        worst_stiffening(elements, blocks, position,
                         model.elements.implicit_modulus.span().subspan(static_cast<std::size_t>(blocks.begin),
                                                                        static_cast<std::size_t>(blocks.size())));
    // not a number where a shape is none
    return std::min(step, of_clusters / std::sqrt(stiffening > 1 ? stiffening : Real(1)));
}

Real watch_stable_steps(Model& model, Column<Real>& stiffness_sum) {
    constexpr Real worth_clusters = 1.25;  // steps that a strained body makes shorter by this
    constexpr Real reserve = 1.05;         // so that the next look finds it standing, too
    BodyTable& bodies = model.bodies;
    const auto now = [&](std::size_t b) { return look_at_stable_step(model, b, model.nodes.position, stiffness_sum); };
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
