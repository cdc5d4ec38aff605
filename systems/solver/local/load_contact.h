// Builds the solver's data of a contact from the tables of the step.
#pragma once

#include <algorithm>
#include <span>

#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// Normal bias b_n of docs/methods/contact.md 3.1 [m/s]. It allows the gap to close within the step, and makes an
/// impact rebound with the coefficient of restitution. Negative gaps are corrected by the split impulse
/// (push_contact.h).
Real contact_bias(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next,
                  const SolverSettings& settings, Real h);

/// Correction of the direction of friction (docs/methods/contact.md 3.3): half of the change of the sliding velocity by
/// the forces of this step, perpendicular to the sliding direction [m/s]. With it, friction acts along the sliding
/// direction at the middle of the step, although the friction law uses the velocity at the end.
///
/// It is zero for ties, without friction or sliding, and for friction that depends on the direction, because such
/// friction itself turns the slip.
Vec3 midpoint_slip(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next);

/// Loads contact `row`. `velocity_next`: predicted node velocities. `local(node)`: velocity row of a moving node in the
/// region. `on_rigid_body(node, weight)`: true if the node moves with a rigid body; the LumpedContact omits such a
/// node.
template <class Local, class Elsewhere>
LumpedContact load_contact(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next,
                           const SolverSettings& settings, Real h, Local&& local, Elsewhere&& on_rigid_body) {
    const Stencil& stencil = inputs.stencil[row];
    LumpedContact contact;
    contact.normal = padded(inputs.normal[row]);
    contact.bias = contact_bias(inputs, row, velocity_next, settings, h);
    Vec3 offset = contact.bias * inputs.normal[row] - inputs.surface_velocity[row];
    contact.node_count = 0;
    contact.diagonal = 0;
    Real lightest = 0;  // greatest inverse mass of the moving nodes [1/kg]
    for (std::size_t a = 0; a < 4; ++a) {
        const Real weight = stencil.weight[a];
        if (weight == 0) continue;
        const Index node = stencil.node[a];
        const Real inverse_mass = inputs.inverse_mass[node];
        if (!(inverse_mass > 0)) {
            offset += weight * velocity_next[node];
            continue;
        }
        if (on_rigid_body(node, weight)) continue;
        const Index index = contact.node_count++;
        contact.weight[index] = weight;
        contact.step[index] = weight * inverse_mass;
        contact.node[index] = local(node);
        contact.diagonal += weight * weight * inverse_mass;
        lightest = std::max(lightest, inverse_mass);
    }
    // A contact counts as immovable if the ratio of its mobility to the greatest inverse mass of its nodes is at most
    // this value. The ratio is about a squared weight. With weights below 1e-6, nodes would have to move a million
    // times faster than the contact.
    constexpr Real smallest_share = 1e-12;
    if (contact.diagonal <= smallest_share * lightest) contact.node_count = 0;
    contact.inverse_diagonal = contact.node_count > 0 ? 1 / contact.diagonal : 0;
    contact.friction = {inputs.static_friction[row], inputs.dynamic_friction[row]};
    offset -= midpoint_slip(inputs, row, velocity_next);
    contact.offset = padded(offset);
    return contact;
}
template <class Local>
LumpedContact load_contact(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next,
                           const SolverSettings& settings, Real h, Local&& local) {
    return load_contact(inputs, row, velocity_next, settings, h, local, [](Index, Real) { return false; });
}

}  // namespace skerry
