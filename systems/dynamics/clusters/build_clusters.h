// The matrices by which the nodes of implicit elements move (docs/methods/clusters.md 2).
#pragma once

#include <cstdint>
#include <span>

#include "components/element_table.h"
#include "components/node_clusters.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// What clusters are made of.
struct ClusterInputs {
    std::span<const Range> body_blocks;
    std::span<const Real> body_cluster_step;  // s
    std::span<const ElementLane> modulus;     // Pa, by block
    std::span<const Real> mass, inverse_mass;
};

/// Nodes chained by implicit elements are a cluster; A = M + beta sum modulus V sum_kl g_k.g_l over those elements, of
/// its moving nodes, and its inverse. Sequential; allocates.
void build_clusters(const ElementInputs& elements, const ClusterInputs& inputs, NodeClusters& clusters);

/// The same where only implicit elements of some bodies have changed, those with a mark (by body): the matrices of all
/// others stay as they are, to the last bit.
void rebuild_clusters(const ElementInputs& elements, const ClusterInputs& inputs,
                      std::span<const std::uint8_t> body_changed, NodeClusters& clusters);

/// How many nodes the largest cluster of a body would have, the entries of all its matrices, and the sum of the cubes
/// of their widths, which is what it takes to invert them.
struct ClusterSizes {
    std::size_t largest = 0, entries = 0, cubes = 0;
};
ClusterSizes cluster_sizes(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus,
                           std::span<const Real> inverse_mass);

}  // namespace skerry
