// The walk of a region whose contacts touch rigid bodies: beside nodes of their own mass and of clusters, nodes of
// bodies that deform in the frame that moves with them (docs/methods/implicit_bodies.md 4). Their velocities are what
// they have beside the motion of the frame.
#pragma once

#include <span>

#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/operators/through_clusters.h"

namespace skerry {

/// One thread, in the order of the contacts. The touched nodes of an implicit body must be rows of the region one after
/// the other, in the order of ImplicitCoupling, as those of a cluster.
class ThroughGroups {
public:
    /// `node`: of the region, rows of NodeTable.
    ThroughGroups(const NodeClusters& clusters, const ImplicitInputs& implicit, const RigidNodes& rigid,
                  std::span<const Index> node)
        : clusters_(clusters, node), implicit_(&implicit), rigid_(&rigid), node_(node) {}

    void apply(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a) {
            const Index place = deforming_place(contact.node[a]);
            if (place == no_index) {
                clusters_.apply_to_node(contact, a, impulse, velocity);
                continue;
            }
            const Vec3 weighted = contact.weight[a] * impulse.head<3>();
            Vec4* const first = velocity + (contact.node[a] - place);
            const std::span<const PaddedMat3> row = implicit_->coupling->row(body_of(contact.node[a]), place);
            for (std::size_t k = 0; k < row.size(); ++k) first[k].noalias() += row[k] * weighted;
        }
    }
    /// The same where bodies do not deform: for what moves positions alone.
    void apply_undeformed(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a)
            if (deforming_place(contact.node[a]) == no_index) clusters_.apply_to_node(contact, a, impulse, velocity);
    }
    /// 1/kg, the share of nodes in the block of W of two contacts.
    Mat3 coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b, true); }
    Mat3 undeformed_coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b, false); }

private:
    std::size_t body_of(Index n) const {
        return static_cast<std::size_t>(rigid_->row(node_[static_cast<std::size_t>(n)]));
    }
    /// Of a node of the region among the touched ones of an implicit body, or no_index.
    Index deforming_place(Index n) const {
        const Index row = implicit_->row(node_[static_cast<std::size_t>(n)], *rigid_);
        return row == no_index ? no_index : implicit_->coupling->place[static_cast<std::size_t>(row)];
    }
    Mat3 coupling_of(const LumpedContact& a, const LumpedContact& b, bool deformed) const {
        Mat3 sum = Mat3::Zero();
        Real lumped = 0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(a.node_count); ++k) {
            const Index place = deforming_place(a.node[k]);
            for (std::size_t l = 0; l < static_cast<std::size_t>(b.node_count); ++l) {
                const Index other = deforming_place(b.node[l]);
                if (place == no_index && other == no_index) {
                    lumped += clusters_.coupling_of_nodes(a, k, b, l);
                } else if (deformed && place != no_index && other != no_index &&
                           body_of(a.node[k]) == body_of(b.node[l])) {
                    const std::span<const PaddedMat3> row = implicit_->coupling->row(body_of(b.node[l]), other);
                    sum += a.weight[k] * b.weight[l] * row[static_cast<std::size_t>(place)].topRows<3>();
                }
            }
        }
        return sum + lumped * Mat3::Identity();
    }

    ThroughClusters clusters_;
    const ImplicitInputs* implicit_;
    const RigidNodes* rigid_;
    std::span<const Index> node_;
};

}  // namespace skerry
