// Moves the nodes of clusters by impulses of forces, with the inertia matrix of each cluster (docs/methods/clusters.md
// 1).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct ClusterKickInputs {
    const NodeClusters& clusters;
    std::span<const Real> mass;                           // kg, by node
    std::span<const std::uint8_t> body_asleep;            // empty if no body is asleep
    std::span<const std::uint16_t> body_unstrained = {};  // may be empty if no body is unstrained

    static ClusterKickInputs bind(const Binder& binder, const NodeClusters& clusters, const NodeTable& node,
                                  const BodyTable& body, const bool& any_asleep) {
        return {.clusters = binder.read(clusters),
                .mass = binder.read(node.mass),
                .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep),
                .body_unstrained = binder.read(body.unstrained)};
    }

    bool is_unstrained(std::size_t cluster) const {
        return !body_unstrained.empty() && body_unstrained[static_cast<std::size_t>(clusters.body[cluster])] != 0;
    }
};

/// Replaces the node masses m in the velocity change of a step by the inertia matrix A of each cluster: velocity_next =
/// velocity + A^-1 m (velocity_next - velocity). On entry velocity_next contains the velocities that the forces give
/// the nodes with the masses m alone. Returns false if there is no cluster (skipped). Parallel over clusters.
///
/// A adds inertia only against differences of velocity. In an unstrained body (in translation without strain) all nodes
/// have one velocity. If velocity_next is also equal at all nodes of one of its clusters, it is left unchanged.
///
/// - `kick`: impulse of the forces on each node, by item of clusters.nodes [N s].
/// - `work`: work memory whose contents persist between steps.
/// - `known`: true if `kick` and `work` still contain the results of a call with equal clusters, velocities and forces.
bool kick_clusters(Executor& executor, const ClusterKickInputs& inputs, std::span<const Vec3> velocity, bool known,
                   Column<Vec3>& kick, Column<Real>& work, std::span<Vec3> velocity_next);

}  // namespace skerry
