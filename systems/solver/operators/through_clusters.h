// Traversal of a region whose contacts touch clusters. An impulse on a node moves all nodes of its cluster
// (docs/methods/clusters.md 4).
#pragma once

#include <span>

#include "components/node_clusters.h"
#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// Traversal with one thread, in ascending order of the contacts. All nodes of a cluster that contacts touch must be
/// consecutive rows of the region, in the order of the cluster. This includes the cluster's nodes without contacts.
class ThroughClusters : public OneThread {
public:
    static constexpr bool own_masses = false;

    /// `node` lists the rows of NodeTable of the region's nodes.
    ThroughClusters(const NodeClusters& clusters, std::span<const Index> node) : clusters_(&clusters), node_(node) {}

    bool in_cluster(Index n) const { return clusters_->cluster(node_[static_cast<std::size_t>(n)]) != no_index; }
    void apply(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a)
            apply_to_node(contact, a, impulse, velocity);
    }
    Real coupling(const LumpedContact& a, const LumpedContact& b) const {
        Real sum = 0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(a.node_count); ++k)
            for (std::size_t l = 0; l < static_cast<std::size_t>(b.node_count); ++l)
                sum += coupling_of_nodes(a, k, b, l);
        return sum;
    }

    /// Applies the part of a contact's impulse that acts on its node `a`. If the node is in a cluster, this moves all
    /// nodes of the cluster.
    void apply_to_node(const LumpedContact& contact, std::size_t a, const Vec4& impulse, Vec4* velocity) const {
        const Index n = contact.node[a], global = node_[static_cast<std::size_t>(n)];
        const Index cluster = clusters_->cluster(global);
        if (cluster == no_index) {
            velocity[n] += contact.step[a] * impulse;
            return;
        }
        const Index index_in_cluster = clusters_->index_in_cluster[global];
        const Vec4 weighted = contact.weight[a] * impulse;
        Vec4* const first = velocity + (n - index_in_cluster);
        const std::span<const Real> row = clusters_->row(cluster, index_in_cluster);
        for (std::size_t k = 0; k < row.size(); ++k) first[k] += row[k] * weighted;
    }
    Real coupling_of_nodes(const LumpedContact& a, std::size_t k, const LumpedContact& b, std::size_t l) const {
        const Index n = a.node[k], global = node_[static_cast<std::size_t>(n)];
        const Index cluster = clusters_->cluster(global);
        if (cluster == no_index) return n == b.node[l] ? a.weight[k] * b.step[l] : 0;
        const Index other = node_[static_cast<std::size_t>(b.node[l])];
        if (clusters_->cluster(other) != cluster) return 0;
        return a.weight[k] * b.weight[l] *
               clusters_->row(
                   cluster,
                   clusters_->index_in_cluster[global])[static_cast<std::size_t>(clusters_->index_in_cluster[other])];
    }

private:
    const NodeClusters* clusters_;
    std::span<const Index> node_;
};

static_assert(RegionTraversal<ThroughClusters>);
static_assert(ContactOperator<LumpedOperatorBy<ThroughClusters>>);

}  // namespace skerry
