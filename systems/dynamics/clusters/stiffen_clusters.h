// Keeps clusters as stiff as their elements have become (docs/methods/clusters.md 3).
#pragma once

#include <span>

#include "components/node_clusters.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

struct StiffenInputs {
    std::span<const Range> body_blocks;
    std::span<const Real> body_cluster_step;  // s; 0: a body without clusters
    std::span<const std::uint8_t> body_asleep;
    std::span<const Vec3> position, velocity;
    std::span<const Real> inverse_mass;
};

/// Implicit elements that are about to become stiffer than they are taken to be are taken to be twice as stiff as they
/// are, and the matrices of their clusters follow. Returns what that adds to the kinetic energy, J. Looks at every
/// implicit element in a way that is cheap while they deform little. Sequential, in element order.
Real stiffen_clusters(const ElementInputs& elements, const StiffenInputs& bodies, std::span<ElementLane> modulus,
                      NodeClusters& clusters);

}  // namespace skerry
