// Builds the inertia matrices of the nodes of implicit elements (docs/methods/clusters.md 2).
#pragma once

#include <cstdint>
#include <span>

#include "components/element_table.h"
#include "components/node_clusters.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Data from which clusters are built.
struct ClusterInputs {
    std::span<const Range> body_blocks;
    std::span<const Real> body_cluster_step;  // s
    std::span<const ElementLane> modulus;     // Pa, by block
    std::span<const Real> mass, inverse_mass;
};

/// Builds the clusters, sets of moving nodes that implicit elements connect, and inverts their matrices
/// A = M + beta sum modulus V sum_kl g_k.g_l, summed over those elements. Sequential; allocates.
void build_clusters(const ElementInputs& elements, const ClusterInputs& inputs, NodeClusters& clusters);

/// Rebuilds the clusters of bodies whose implicit elements have changed, marked in `body_changed` (by body). The
/// matrices of all other bodies stay bitwise the same.
void rebuild_clusters(const ElementInputs& elements, const ClusterInputs& inputs,
                      std::span<const std::uint8_t> body_changed, NodeClusters& clusters);

/// Sizes of the clusters that a body would have: the nodes of the largest one, the entries of all matrices, and the sum
/// of the cubes of their widths, which is proportional to the cost of inverting them.
struct ClusterSizes {
    std::size_t largest = 0, entries = 0, cubes = 0;
};
ClusterSizes cluster_sizes(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus,
                           std::span<const Real> inverse_mass);

}  // namespace skerry
