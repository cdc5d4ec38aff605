// Builds the clusters of nodes that implicit elements connect, and their inertia matrices (docs/methods/clusters.md 2).
#pragma once

#include <cstdint>
#include <span>

#include "components/element_table.h"
#include "components/node_clusters.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Columns of bodies, elements and nodes from which clusters are built.
struct ClusterInputs {
    std::span<const Range> body_blocks;
    std::span<const Real> body_cluster_step;  // longest step at which the implicit elements are stable; 0: none [s]
    std::span<const ElementLane> modulus;     // by block: assumed modulus; 0 for an explicit element [Pa]
    std::span<const Real> mass, inverse_mass;
};

/// Builds the clusters, which are sets of moving nodes that implicit elements connect, and inverts their inertia
/// matrices A (docs/methods/clusters.md 1). M is the diagonal matrix of lumped masses and `step` is body_cluster_step.
/// Implicit element e has the assumed modulus c_e and the volume V_e, and g_k is the gradient of its shape function of
/// node k:
///     A_kl = M_kl + beta sum_e c_e V_e g_k.g_l,     beta = (step/1.8)^2 (inertia_factor()).
/// Sequential; allocates.
void build_clusters(const ElementInputs& elements, const ClusterInputs& inputs, NodeClusters& clusters);

/// Rebuilds the clusters of bodies whose implicit elements have changed, marked in `body_changed` (by body). The
/// inertia matrices of the clusters of all other bodies stay bitwise equal.
void rebuild_clusters(const ElementInputs& elements, const ClusterInputs& inputs,
                      std::span<const std::uint8_t> body_changed, NodeClusters& clusters);

/// Sizes of the clusters that build_clusters() would make for a body:
/// - `largest`: node count of the largest cluster;
/// - `entries`: number of entries of all inertia matrices together;
/// - `cubes`: sum of the cubes of the node counts, to which the cost of inverting the matrices is proportional.
/// `modulus`: assumed moduli of the elements; row 0 belongs to the block blocks.begin.
struct ClusterSizes {
    std::size_t largest = 0, entries = 0, cubes = 0;
};
ClusterSizes cluster_sizes(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus,
                           std::span<const Real> inverse_mass);

}  // namespace skerry
