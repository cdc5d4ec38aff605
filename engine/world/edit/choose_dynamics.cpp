// Choice between explicit and implicit dynamics for a body (docs/methods/implicit_bodies.md 6).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/world/edit/edit_model.h"
#include "engine/world/step/step.h"

namespace skerry {

namespace {

// Cost of a step of an implicit body, as a power law of its number of nodes. The law was fitted to the output of
// profile_implicit_factor --steps for cubes of 125 to 2,197 nodes that lie on a face.
constexpr Real fitted_nodes = 729;
constexpr Real step_time = 2.5e6, step_power = 1.75;  // [ns]
// Fraction of the cost of an implicit step that is spent on contacts. If an implicit body takes long steps, its
// contacts still take part in every short step of the other bodies. For a cube on a face the fraction is a half or
// more.
constexpr Real contact_share = 0.5;
// Cost of factorising the matrix of an implicit body and of computing the matrix columns that contacts need [ns].
constexpr Real factor_time = 150e6, factor_power = 2.7;
// Assumed number of factorisations in a simulated second. A change of the step length requires a new factorisation.
constexpr Real factors_a_second = 1;
/// Least ratio of explicit to implicit cost for which a body becomes implicit. It is well above 1, because implicit
/// steps damp vibrations and the cost estimates are rough.
constexpr Real least_saving = 2;
constexpr Real most_strain = 0.02;  // largest strain for which linear elasticity is valid
constexpr Real fall = 10;           // assumed height of a fall, divided by the size of the body

/// Largest strain expected in the materials of a body, under its own weight or in an impact. The impact strain is v/c,
/// as in a bar that is stopped. Here c is the wave speed, and the impact speed v combines the initial speed and a fall.
Real largest_strain(const Model& model, const NewBody& body) {
    Vec3 lower = body.nodes.front(), upper = lower;
    for (const Vec3& x : body.nodes) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
    const Real size = (upper - lower).maxCoeff(), gravity = model.settings.gravity.norm();
    const Real moves = body.velocity.norm() + body.angular_velocity.norm() * size / 2;
    const Real speed = std::sqrt(moves * moves + 2 * gravity * fall * size);
    Real strain = 0;
    for (std::size_t t = 0; t < body.tetrahedra.size(); ++t) {
        const auto material = static_cast<std::size_t>(body.material_of(t));
        const Real modulus = model.materials.young_modulus[material];
        const Real density = model.materials.constants[material].density;
        strain = std::max({strain, density * gravity * size / modulus, speed * std::sqrt(density / modulus)});
    }
    return strain;
}

struct ExplicitBody {
    Real step;      // stable step [s]
    Real elements;  // number of elements
};

/// Stable step and number of elements that a body would have if it were explicit. They are computed in a model that
/// contains only this body.
ExplicitBody as_explicit(const Model& model, const NewBody& body) {
    Model alone;
    alone.settings = model.settings;
    alone.tuning = model.tuning;
    alone.materials = model.materials;
    Column<Real> stiffness_sum;
    append_body(alone, stiffness_sum, body);
    return {alone.bodies.rest_step[0] * model.tuning.step_safety,
            static_cast<Real>(alone.elements.volume.size() * element_lanes)};
}

}  // namespace

BodyDynamics choose_dynamics(const Model& model, const NewBody& body, DynamicsEstimate& estimate) {
    constexpr Real ns = 1e-9;
    const ExplicitBody alone = as_explicit(model, body);
    const Real others = static_cast<Real>(model.elements.volume.size() * element_lanes);
    const Real nodes = static_cast<Real>(body.nodes.size()) / fitted_nodes;
    estimate = {};
    estimate.implicit_step = step_with_frame(model);
    estimate.deforming_step = std::max(estimate.implicit_step, model.settings.implicit_step);
    estimate.explicit_step = std::min(trusted_step(model), alone.step);
    estimate.explicit_cost = ns * element_cost * (others + alone.elements) / estimate.explicit_step;
    const Real one_step = step_time * std::pow(nodes, step_power);
    estimate.implicit_cost = ns * ((element_cost * others + contact_share * one_step) / estimate.implicit_step +
                                   (1 - contact_share) * one_step / estimate.deforming_step +
                                   factors_a_second * factor_time * std::pow(nodes, factor_power));
    estimate.strain = largest_strain(model, body);
    const Real damps = 2 * model.settings.theta - 1;
    if (damps > 0) estimate.damped_above = 1 / (4 * std::numbers::pi * estimate.deforming_step);
    estimate.reason = DynamicsReason::cost;
    if (body.self_contact) {
        estimate.reason = DynamicsReason::self_contact;
    } else if (!(estimate.strain <= most_strain)) {
        estimate.reason = DynamicsReason::strain;
    } else if (estimate.implicit_cost * least_saving < estimate.explicit_cost) {
        return BodyDynamics::implicit_elastic;
    }
    return BodyDynamics::explicit_elastic;
}

}  // namespace skerry
