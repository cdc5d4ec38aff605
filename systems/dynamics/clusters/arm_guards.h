// Activates the guards of a body (docs/methods/elasticity.md 7.7).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Output columns, by block of the body.
struct GuardOutputs {
    std::span<ElementLane> modulus, volume;  // Pa; m^3
};

/// A guard acts if all of its moving corners are nodes of one cluster of the other implicit elements of the body. It
/// then gets its volume and a modulus, which is raised as it comes into play (stiffen_clusters.h). Other guards get 0
/// for both. A guard that already acts keeps its assumed modulus. Sequential; allocates.
void arm_guards(const ElementInputs& elements, Range blocks, std::span<const Real> inverse_mass,
                const GuardOutputs& out);

/// Deactivates all guards of a body: sets their volumes to 0. Both columns are by block of the body.
void disarm_guards(std::span<const ElementPart> part, std::span<ElementLane> volume);

}  // namespace skerry
