// Which guards act (docs/methods/elasticity.md 7.7).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Of each block of the body.
struct GuardOutputs {
    std::span<ElementLane> modulus, volume;  // Pa; m^3
};

/// A guard acts where all of its moving corners are nodes of one cluster, which the other implicit elements of the body
/// chain: it has a modulus, which is raised as it comes into play (stiffen_clusters.h), and its volume. Others have
/// neither. One that acts already keeps the modulus that it is taken to have. Sequential; allocates.
void arm_guards(const ElementInputs& elements, Range blocks, std::span<const Real> inverse_mass,
                const GuardOutputs& out);

/// None acts. By block of the body.
void disarm_guards(std::span<const ElementPart> part, std::span<ElementLane> volume);

}  // namespace skerry
