// Choice between explicit and implicit dynamics for a body (docs/methods/implicit_bodies.md 6).
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/world/edit/edit_model.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

constexpr Real ns = 1e-9;  // one nanosecond in seconds; the costs below are in ns
// Cost of a step of an implicit body: step_time * (number of nodes / fitted_nodes)^step_power. The law was fitted to
// the output of profile_implicit_factor --steps for cubes of 125 to 2,197 nodes that lie on a face.
constexpr Real fitted_nodes = 729;
constexpr Real step_time = 2.5e6, step_power = 1.75;  // step_time [ns]
// Share of step_time that contacts take (measured for a cube on a face: a half or more). Contacts are solved in each
// step of the world, even if the implicit body itself takes longer steps.
constexpr Real contact_share = 0.5;
// Cost of the contacts of an implicit body in a pile, divided by that of a cube on a face. Measured: 26 to 57, in piles
// of 27 cubes (27 to 729 nodes) and of 27 balls, with steps of 1 to 8 ms.
constexpr Real pile_contacts = 40;
// Cost of the contacts of an explicit body in the same piles, per step and node [ns].
constexpr Real node_contacts = 200;
// Cost of factorising the matrix of an implicit body and of computing those columns of the inverse matrix that contacts
// need [ns]: factor_time * (number of nodes / fitted_nodes)^factor_power.
constexpr Real factor_time = 150e6, factor_power = 2.7;
// Assumed number of factorisations in a simulated second. A change of the step length requires a new factorisation.
constexpr Real factors_a_second = 1;
/// Least ratio of explicit to implicit cost for which a body becomes implicit. It is well above 1, because implicit
/// steps damp vibrations and the cost estimates are rough.
constexpr Real least_saving = 2;
constexpr Real most_strain = 0.02;  // largest strain for which linear elasticity is valid
constexpr Real fall = 10;           // assumed height of a fall, divided by the size of the body

/// Largest strain expected in the materials of a body, under its own weight or in an impact
/// (docs/methods/implicit_bodies.md 6). The impact follows a fall through `fall` times the size of the body, which
/// begins with the initial speed.
Real largest_strain(const Model& model, const NewBody& body) {
    Vec3 lower = body.nodes.front(), upper = lower;
    for (const Vec3& x : body.nodes) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
    const Vec3 default_gravity = Settings{}.gravity;
    const Real size = (upper - lower).maxCoeff();
    // without gravity nothing is known about later speeds, so the default gravity is used
    const Real gravity = (model.settings.gravity == Vec3::Zero() ? default_gravity : model.settings.gravity).norm();
    const Real moves = body.velocity.norm() + body.angular_velocity.norm() * size / 2;
    const Real speed = std::sqrt(moves * moves + 2 * gravity * fall * size);
    Real strain = 0;
    for (std::size_t t = 0; t < body.tetrahedra.size(); ++t) {
        const auto material = static_cast<std::size_t>(body.material_of(t));
        const Real modulus = model.materials.young_modulus[material];
        const Real density = model.materials.constants[material].density;
        // strain under weight, and strain v/c of a bar that is stopped at the speed v, with the wave speed c
        strain = std::max({strain, density * gravity * size / modulus, speed * std::sqrt(density / modulus)});
    }
    return strain;
}

/// Computes the KnownElements of a body by appending it to an empty model.
KnownElements try_alone(const Model& model, const NewBody& body) {
    Model alone;
    alone.settings = model.settings;
    alone.tuning = model.tuning;
    alone.materials = model.materials;
    Column<Real> stiffness_sum;
    append_body(alone, stiffness_sum, body);
    return std::move(alone.known_elements.back());
}

/// Cost of elements in a step [s]. `blocks`: number of element blocks.
Real cost_of_elements(std::size_t blocks) {
    return ns * element_cost * static_cast<Real>(blocks * element_lanes);
}

/// Writes to `estimate` the step lengths and the costs (computing time per simulated second) of explicit and of
/// implicit dynamics.
void compare_costs(const Model& model, const NewBody& body, const KnownElements& elements, DynamicsEstimate& estimate) {
    const Real others = cost_of_elements(model.elements.volume.size());
    const auto nodes = static_cast<Real>(body.nodes.size());
    const Real own = cost_of_elements(elements.mass_share.size()) + ns * node_contacts * nodes;
    const Real size = nodes / fitted_nodes, one_step = step_time * std::pow(size, step_power);
    estimate.implicit_step = step_with_frame(model);
    estimate.deforming_step = std::max(estimate.implicit_step, model.settings.implicit_step);
    estimate.explicit_step = std::min(longest_allowed_step(model), elements.rest_step * model.tuning.step_safety);
    estimate.explicit_cost = (others + own) / estimate.explicit_step;
    estimate.implicit_cost = (others + ns * pile_contacts * contact_share * one_step) / estimate.implicit_step +
                             ns * (1 - contact_share) * one_step / estimate.deforming_step +
                             ns * factors_a_second * factor_time * std::pow(size, factor_power);
    const Real damps = 2 * model.settings.theta - 1;
    if (damps > 0) estimate.damped_above = 1 / (4 * std::numbers::pi * estimate.deforming_step);
}

/// True if has(row) returns true for at least one material of a body. `row`: row of MaterialTable.
bool any_material(Index material, std::span<const Index> tetrahedron_material, auto&& has) {
    const auto of_row = [&](Index row) { return has(static_cast<std::size_t>(row)); };
    return tetrahedron_material.empty() ? of_row(material) : std::ranges::any_of(tetrahedron_material, of_row);
}

bool sets_losses(const Model& model, Index material, std::span<const Index> tetrahedron_material) {
    return any_material(material, tetrahedron_material,
                        [&](std::size_t row) { return model.materials.sets_losses[row] != 0; });
}

bool yields(const Model& model, Index material, std::span<const Index> tetrahedron_material) {
    return any_material(material, tetrahedron_material,
                        [&](std::size_t row) { return model.materials.constants[row].yields(); });
}

}  // namespace

void require_implicit_materials(const Model& model, Index material, std::span<const Index> tetrahedron_material,
                                const std::string& name) {
    if (sets_losses(model, material, tetrahedron_material)) refuse_losses(name);
    if (!yields(model, material, tetrahedron_material)) return;
    refuse(name.empty() ? "body" : "body '" + name + "'", "plasticity", "a material of an implicit body that yields",
           "no plasticity, because implicit bodies do not yield",
           "remove it from the material, or make the body explicit");
}

void refuse_losses(const std::string& body) {
    refuse(body.empty() ? "body" : "body '" + body + "'", "loss_factor",
           "a material of an implicit body that sets a loss factor above 0",
           "no loss_factor, because implicit bodies have no such losses",
           "remove it from the material, or make the body explicit");
}

BodyDynamics choose_dynamics(const Model& model, const NewBody& body, DynamicsEstimate& estimate,
                             std::optional<KnownElements>& trial) {
    estimate = {};
    estimate.strain = largest_strain(model, body);
    estimate.reason = body.self_contact                                              ? DynamicsReason::self_contact
                      : sets_losses(model, body.material, body.tetrahedron_material) ? DynamicsReason::losses
                      : yields(model, body.material, body.tetrahedron_material)      ? DynamicsReason::plasticity
                      : !(estimate.strain <= most_strain)                            ? DynamicsReason::strain
                                                                                     : DynamicsReason::cost;
    if (estimate.reason != DynamicsReason::cost) return BodyDynamics::explicit_elastic;
    const KnownElements* known = known_elements(model, body);
    if (!known) known = &trial.emplace(try_alone(model, body));
    // A body without a valid stable step has a faulty mesh or material. It becomes explicit, so that validate_step()
    // refuses it.
    if (!(known->rest_step > 0) || !std::isfinite(known->rest_step)) return BodyDynamics::explicit_elastic;
    compare_costs(model, body, *known, estimate);
    return estimate.implicit_cost * least_saving < estimate.explicit_cost ? BodyDynamics::implicit_elastic
                                                                          : BodyDynamics::explicit_elastic;
}

Index outdated_choice(const Model& model, DynamicsEstimate& updated) {
    // A choice is tested again if the implicit step that it assumed exceeds the present one by more than this factor.
    constexpr Real much_longer = 1.5;
    if (model.implicit_nodes.size() == 0) return no_index;
    const Real step = step_with_frame(model), cost_of_all = cost_of_elements(model.elements.volume.size());
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        const DynamicsEstimate& old = model.body_records[b].choice;
        if (old.reason != DynamicsReason::cost || model.dynamics_of(b) != BodyDynamics::implicit_elastic ||
            !(old.implicit_step > much_longer * step))
            continue;
        updated = old;
        updated.implicit_step = step;
        updated.deforming_step = std::max(step, model.settings.implicit_step);
        updated.explicit_step = std::min(old.explicit_step, step);
        // The bodies of the first estimate count twice: in `cost_of_all` and in the costs of `old`. This overestimates
        // the explicit cost more, because the explicit step is shorter. So a body becomes explicit only if this
        // certainly saves time.
        updated.explicit_cost = (cost_of_all + old.explicit_cost * old.explicit_step) / updated.explicit_step;
        updated.implicit_cost = (cost_of_all + old.implicit_cost * old.implicit_step) / step;
        updated.damped_above = 0;  // an explicit body is not damped by its steps
        if (!(updated.implicit_cost * least_saving < updated.explicit_cost)) return static_cast<Index>(b);
    }
    return no_index;
}

}  // namespace skerry
