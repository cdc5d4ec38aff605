#include "systems/dynamics/clusters/kick_clusters.h"

#include "jobs/parallel_for.h"

namespace skerry {

namespace {

/// sum of the entries of a row times the vectors. Four sums side by side: one alone would wait for itself.
Vec3 product(std::span<const Real> row, const Vec3* vector) {
    Vec3 sum[4] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    std::size_t k = 0;
    for (; k + 4 <= row.size(); k += 4)
        for (std::size_t i = 0; i < 4; ++i) sum[i] += row[k + i] * vector[k + i];
    for (; k < row.size(); ++k) sum[0] += row[k] * vector[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace

bool kick_clusters(Executor& executor, const ClusterKickInputs& inputs, std::span<const Vec3> velocity,
                   Column<Vec3>& kick, std::span<Vec3> velocity_next) {
    const NodeClusters& clusters = inputs.clusters;
    if (clusters.empty()) return false;
    kick.resize(clusters.nodes.item.size());
    parallel_for(executor, clusters.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c) {
            if (!inputs.body_asleep.empty() && inputs.body_asleep[static_cast<std::size_t>(clusters.body[c])]) continue;
            const std::span<const Index> nodes = clusters.nodes[c];
            Vec3* const of_cluster = kick.data() + clusters.nodes.offset[c];
            for (std::size_t k = 0; k < nodes.size(); ++k) {
                const auto n = static_cast<std::size_t>(nodes[k]);
                of_cluster[k] = inputs.mass[n] * (velocity_next[n] - velocity[n]);
            }
            for (std::size_t k = 0; k < nodes.size(); ++k) {
                const auto n = static_cast<std::size_t>(nodes[k]);
                velocity_next[n] =
                    velocity[n] + product(clusters.row(static_cast<Index>(c), static_cast<Index>(k)), of_cluster);
            }
        }
    });
    return true;
}

}  // namespace skerry
