// The walk of a region whose contacts touch rigid bodies: beside nodes of their own mass and of clusters, nodes of
// bodies that deform in the frame that moves with them (docs/methods/implicit_bodies.md 4). Their velocities are what
// they have beside the motion of the frame.
#pragma once

#include <span>

#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/local/rigid_part.h"
#include "systems/solver/operators/through_clusters.h"

namespace skerry {

/// One thread, in the order of the contacts. The touched nodes of an implicit body must be rows of the region one after
/// the other, in the order of ImplicitCoupling, as those of a cluster.
class ThroughGroups {
public:
    /// `node`: of the region, rows of NodeTable.
    ThroughGroups(const NodeClusters& clusters, const ImplicitInputs& implicit, const RigidInputs& rigid,
                  std::span<const Index> node)
        : clusters_(clusters, node), implicit_(&implicit), rigid_(&rigid), node_(node) {}

    void apply(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a) {
            const Index place = deforming_place(contact.node[a]);
            if (place == no_index) {
                clusters_.apply_to_node(contact, a, impulse, velocity);
                continue;
            }
            move_nodes_of(contact.node[a], place, contact.weight[a] * impulse.head<3>(), velocity);
        }
    }
    /// The same, but what falls to nodes that deform a body is added to `sum`, by node of the region, for spread().
    void collect(const LumpedContact& contact, const Vec4& impulse, Vec4* sum, Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a) {
            if (deforming_place(contact.node[a]) == no_index)
                clusters_.apply_to_node(contact, a, impulse, velocity);
            else
                sum[contact.node[a]] += contact.weight[a] * impulse;
        }
    }
    /// An impulse on a node that deforms a body.
    void spread(Index n, const Vec4& impulse, Vec4* velocity) const {
        move_nodes_of(n, deforming_place(n), impulse.head<3>(), velocity);
    }
    /// The same where bodies do not deform: for what moves positions alone.
    void apply_undeformed(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a)
            if (deforming_place(contact.node[a]) == no_index) clusters_.apply_to_node(contact, a, impulse, velocity);
    }
    /// 1/kg, the share of nodes in the block of W of two contacts.
    Mat3 coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b, true); }
    Mat3 undeformed_coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b, false); }

    const RigidInputs& rigid() const { return *rigid_; }
    bool in_cluster(Index n) const { return clusters_.in_cluster(n); }
    /// Row of BodyTable of a node of the region.
    Index owner(Index n) const {
        return rigid_->nodes.node_body[static_cast<std::size_t>(node_[static_cast<std::size_t>(n)])];
    }
    bool moves_with_rigid(Index n) const { return rigid_->nodes.row(node_[static_cast<std::size_t>(n)]) != no_index; }
    Index rigid_row(Index n) const { return rigid_->nodes.row(node_[static_cast<std::size_t>(n)]); }
    /// m, of a node of a rigid body, from its centre.
    Vec3 arm(Index n) const {
        return rigid_->position[static_cast<std::size_t>(node_[static_cast<std::size_t>(n)])] -
               rigid_->center[body_of(n)];
    }
    /// Whether a body, by row of RigidBodyTable, has nodes that contacts see deform.
    bool deforms(Index body) const {
        return implicit_->any() && !implicit_->coupling->nodes[static_cast<std::size_t>(body)].empty();
    }
    /// 1/kg, what an impulse on node `m` of an implicit body gives its node `n` in all.
    Mat3 response(Index n, Index m) const {
        const std::size_t r = body_of(m);
        const Mat3 turned = rigid_->inverse_inertia[r] * cross_matrix(arm(m));
        const std::span<const PaddedMat3> row = implicit_->coupling->row(r, deforming_place(m));
        return row[static_cast<std::size_t>(deforming_place(n))].topRows<3>() +
               rigid_->inverse_mass(r) * Mat3::Identity() - cross_matrix(arm(n)) * turned;
    }
    /// Nodes that an impulse on one moves.
    std::size_t moved_by(Index n) const {
        const Index place = deforming_place(n);
        return place == no_index ? 1 : implicit_->coupling->row(body_of(n), place).size();
    }

private:
    /// By an impulse on node `n` of the region, in its place among the touched ones of its body.
    void move_nodes_of(Index n, Index place, const Vec3& impulse, Vec4* velocity) const {
        Vec4* const first = velocity + (n - place);
        const std::span<const PaddedMat3> row = implicit_->coupling->row(body_of(n), place);
        for (std::size_t k = 0; k < row.size(); ++k) first[k].noalias() += row[k] * impulse;
    }
    std::size_t body_of(Index n) const {
        return static_cast<std::size_t>(rigid_->nodes.row(node_[static_cast<std::size_t>(n)]));
    }
    /// Of a node of the region among the touched ones of an implicit body, or no_index.
    Index deforming_place(Index n) const {
        const Index row = implicit_->row(node_[static_cast<std::size_t>(n)], rigid_->nodes);
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
    const RigidInputs* rigid_;
    std::span<const Index> node_;
};

}  // namespace skerry
