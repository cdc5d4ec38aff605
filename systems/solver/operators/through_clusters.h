// The walk of a region whose contacts touch clusters: an impulse on a node of a cluster moves all of them
// (docs/methods/clusters.md 4).
#pragma once

#include <span>

#include "components/node_clusters.h"
#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// One thread, in the order of the contacts. The nodes of a cluster must be rows of the region one after the other, in
/// the order of the cluster, whether contacts name them or not.
class ThroughClusters : public InOrder {
public:
    static constexpr bool own_masses = false;

    /// `node`: of the region, rows of NodeTable.
    ThroughClusters(const NodeClusters& clusters, std::span<const Index> node) : clusters_(&clusters), node_(node) {}

    void apply(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        for (Index a = 0; a < contact.node_count; ++a) {
            const Index n = contact.node[a], global = node_[static_cast<std::size_t>(n)];
            const Index cluster = clusters_->cluster(global);
            if (cluster == no_index) {
                velocity[n] += contact.step[static_cast<std::size_t>(a)] * impulse;
                continue;
            }
            const Index place = clusters_->place[global];
            const Vec4 weighted = contact.weight[static_cast<std::size_t>(a)] * impulse;
            Vec4* const first = velocity + (n - place);
            const std::span<const Real> row = clusters_->row(cluster, place);
            for (std::size_t k = 0; k < row.size(); ++k) first[k] += row[k] * weighted;
        }
    }
    Real coupling(const LumpedContact& a, const LumpedContact& b) const {
        Real sum = 0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(a.node_count); ++k) {
            const Index n = a.node[k], global = node_[static_cast<std::size_t>(n)];
            const Index cluster = clusters_->cluster(global);
            for (std::size_t l = 0; l < static_cast<std::size_t>(b.node_count); ++l) {
                if (cluster == no_index) {
                    if (n == b.node[l]) sum += a.weight[k] * b.step[l];
                    continue;
                }
                const Index other = node_[static_cast<std::size_t>(b.node[l])];
                if (clusters_->cluster(other) == cluster)
                    sum += a.weight[k] * b.weight[l] *
                           clusters_->row(cluster,
                                          clusters_->place[global])[static_cast<std::size_t>(clusters_->place[other])];
            }
        }
        return sum;
    }

private:
    const NodeClusters* clusters_;
    std::span<const Index> node_;
};

static_assert(RegionWalk<ThroughClusters>);
static_assert(ContactOperator<LumpedOperatorBy<ThroughClusters>>);

}  // namespace skerry
