// Clusters: groups of nodes whose accelerations are coupled by one inertia matrix, because the elements between them
// are integrated implicitly (docs/methods/clusters.md).
#pragma once

#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// Clusters of all bodies. An impulse on one node changes the velocity of every node of its cluster. A row of the
/// inverse inertia matrix gives these velocities. build_clusters makes the clusters from the implicit elements, and
/// stiffen_clusters updates them.
struct NodeClusters {
    Ragged<Index> nodes;              // by cluster: its nodes that can move, as ascending rows of NodeTable
    Column<Index> body;               // by cluster: row of BodyTable
    Column<std::size_t> first_entry;  // by cluster: index in `inverse` of the first entry of its matrix
    Column<Real> inverse;             // inverse A^-1 of the inertia matrix A of each cluster, row by row [1/kg]
    // `cluster_of`: cluster of each node, or no_index. `index_in_cluster`: index of the node in its cluster. Both
    // columns are empty if there are no clusters.
    Column<Index> cluster_of, index_in_cluster;

    std::size_t size() const { return body.size(); }
    bool empty() const { return body.empty(); }
    void clear() {
        nodes.clear();
        body.clear();
        first_entry.clear();
        inverse.clear();
        cluster_of.clear();
        index_in_cluster.clear();
    }
    /// The cluster of a node, or no_index.
    Index cluster(Index node) const { return cluster_of.empty() ? no_index : cluster_of[node]; }
    /// A node that represents all nodes coupled with `node`: the first node of its cluster, or `node` itself if it
    /// belongs to no cluster.
    Index leader(Index node) const {
        const Index own_cluster = cluster(node);
        return own_cluster == no_index ? node : nodes.item[nodes.offset[own_cluster]];
    }
    /// Velocities of all nodes of a cluster per unit impulse on node number `at` of the cluster [1/kg].
    std::span<const Real> row(Index cluster, Index at) const {
        const auto c = static_cast<std::size_t>(cluster);
        const std::size_t count = nodes[c].size();
        return inverse.span().subspan(first_entry[c] + static_cast<std::size_t>(at) * count, count);
    }
};

}  // namespace skerry
