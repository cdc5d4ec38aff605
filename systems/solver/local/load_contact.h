// A contact as the solver works with it, from the rows of the step's tables.
#pragma once

#include <algorithm>
#include <span>

#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// b_n of docs/methods/contact.md 3.1: the gap may close within the step; an impact turns back with the restitution.
/// Gaps below zero are left to push_out_region.
Real contact_bias(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next,
                  const SolverSettings& settings, Real h);

/// m/s, half of what forces turn the slip by in this step, at right angles to it. The law of friction looks at the
/// velocity after the impulse; without this the direction of sliding would be that at the end of the step's kick, an
/// error of first order, instead of that in its middle. Zero where nothing slides, without friction, or where it goes
/// straight on.
Vec3 midpoint_slip(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next);

/// Loads contact `row`; `local(node)` gives the region's row of a moving node. `velocity_next` is what the contact sees
/// before the solve. A node of which `elsewhere(node, weight)` is true moves with a rigid body: no node of the contact.
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
    Real lightest = 0;  // 1/kg
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
    // a moving node whose share is below 1e-6 would have to move a million times faster than the contact to stop it: it
    // cannot
    constexpr Real smallest_share = 1e-12;  // of the squared weight
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
