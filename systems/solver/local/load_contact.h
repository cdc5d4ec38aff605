// Builds the solver's data of a contact from the rows of the step's tables.
#pragma once

#include <algorithm>
#include <span>

#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// b_n of docs/methods/contact.md 3.1. The gap may close within the step; an impact rebounds with the restitution. Gaps
/// below zero are left to the split impulse (push_contact.h).
Real contact_bias(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next,
                  const SolverSettings& settings, Real h);

/// Half of the turn of the sliding velocity by the forces of this step: its component perpendicular to the sliding
/// direction. The friction law uses the velocity after the impulse. Without this correction it would act along the
/// sliding direction at the end of the kick, a first-order error, instead of the middle. Zero without sliding, friction
/// or turn [m/s]
Vec3 midpoint_slip(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next);

/// Loads contact `row`. `local(node)` returns the region's row of a moving node. `velocity_next` is the predicted
/// velocity of the nodes. Nodes for which `elsewhere(node, weight)` is true move with a rigid body; they are no nodes
/// of the contact.
template <class Local, class Elsewhere>
LumpedContact load_contact(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next,
                           const SolverSettings& settings, Real h, Local&& local, Elsewhere&& elsewhere) {
    const Stencil& stencil = inputs.stencil[row];
    LumpedContact contact;
    contact.normal = padded(inputs.normal[row]);
    contact.bias = contact_bias(inputs, row, velocity_next, settings, h);
    Vec3 offset = contact.bias * inputs.normal[row] - inputs.surface_velocity[row];
    contact.node_count = 0;
    contact.diagonal = 0;
    Real lightest = 0;  // [1/kg]
    for (std::size_t a = 0; a < 4; ++a) {
        const Real weight = stencil.weight[a];
        if (weight == 0) continue;
        const Index node = stencil.node[a];
        const Real inverse_mass = inputs.inverse_mass[node];
        if (!(inverse_mass > 0)) {
            offset += weight * velocity_next[node];
            continue;
        }
        if (elsewhere(node, weight)) continue;
        const Index place = contact.node_count++;
        contact.weight[place] = weight;
        contact.step[place] = weight * inverse_mass;
        contact.node[place] = local(node);
        contact.diagonal += weight * weight * inverse_mass;
        lightest = std::max(lightest, inverse_mass);
    }
    // A moving node with a share below 1e-6 would have to move a million times faster than the contact to stop it, so
    // it cannot.
    constexpr Real smallest_share = 1e-12;  // ratio of squared weights
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
