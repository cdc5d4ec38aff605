// Activates inversion barriers (guards) of tetrahedra inside the clusters of a body (docs/methods/elasticity.md 7.7).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Output columns of arm_guards, with one row per element block of the body.
struct GuardOutputs {
    std::span<ElementLane> modulus, volume;  // assumed modulus [Pa], volume [m^3]; 0 for an inactive guard
};

/// Activates the guard (inversion barrier) of every tetrahedron whose moving corners all belong to one cluster. A
/// cluster is a set of moving nodes that implicit elements connect; guards themselves connect no nodes. Sequential;
/// allocates.
/// - An active guard gets the volume of its tetrahedron and an assumed modulus, the stiffness that the implicit
///   integration assumes. stiffen_clusters raises this modulus when the guard is compressed; here it does not decrease.
/// - All other guards get volume 0 and modulus 0.
void arm_guards(const ElementInputs& elements, Range blocks, std::span<const Real> inverse_mass,
                const GuardOutputs& out);

/// Deactivates all guards (inversion barriers) of a body: sets their volumes to 0. `part` and `volume` have one row per
/// element block of the body.
void disarm_guards(std::span<const ElementPart> part, std::span<ElementLane> volume);

}  // namespace skerry
