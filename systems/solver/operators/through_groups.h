// Traversal of a region whose contacts touch rigid bodies. The region may also have nodes with their own mass, of
// clusters, and of implicit bodies. Velocities of implicit nodes are relative to the moving frame in which their body
// deforms (docs/methods/implicit_bodies.md 4).
#pragma once

#include <span>

#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/local/rigid_part.h"
#include "systems/solver/operators/through_clusters.h"

namespace skerry {

/// Traversal by one thread, in ascending order of the contacts. The nodes of an implicit body that have contacts must
/// be consecutive rows of the region, in the order of ImplicitCoupling.
class ThroughGroups : public OneThread {
public:
    /// `node` lists the rows of NodeTable of the region's nodes.
    ThroughGroups(const NodeClusters& clusters, const ImplicitInputs& implicit, const RigidInputs& rigid,
                  std::span<const Index> node)
        : clusters_(clusters, node), implicit_(&implicit), rigid_(&rigid), node_(node) {}

    bool any_deforms() const { return implicit_->any(); }
    /// Applies an impulse of a contact to all nodes that are on no implicit body. For nodes of implicit bodies it adds
    /// the weighted impulse to `sum` (by node of the region), from which SpreadImpulses later computes their motion.
    void collect(const LumpedContact& contact, const Vec4& impulse, Vec4* sum, Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a) {
            if (touched_index(contact.node[a]) == no_index)
                clusters_.apply_to_node(contact, a, impulse, velocity);
            else
                sum[contact.node[a]] += contact.weight[a] * impulse;
        }
    }
    /// Applies the part of a contact's impulse that acts on node `a` of the contact. The node must be on no implicit
    /// body.
    void apply_to_node(const LumpedContact& contact, std::size_t a, const Vec4& impulse, Vec4* velocity) const {
        clusters_.apply_to_node(contact, a, impulse, velocity);
    }
    /// Applies an impulse to all nodes that are on no implicit body. It serves corrections in which implicit bodies do
    /// not deform: the split impulse and rigid-body modes. The caller moves the rigid bodies and the frames of implicit
    /// bodies.
    [[gnu::always_inline]] void apply_undeformed(const LumpedContact& contact, const Vec4& impulse,
                                                 Vec4* velocity) const {
        for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a)
            if (touched_index(contact.node[a]) == no_index) clusters_.apply_to_node(contact, a, impulse, velocity);
    }
    /// Contribution of the nodes to the block of W for contacts a and b [1/kg]
    Mat3 coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b, true); }
    Mat3 undeformed_coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b, false); }

    const RigidInputs& rigid() const { return *rigid_; }
    bool in_cluster(Index n) const { return clusters_.in_cluster(n); }
    /// Row of BodyTable of the body that owns node `n` of the region.
    Index owner(Index n) const {
        return rigid_->nodes.node_body[static_cast<std::size_t>(node_[static_cast<std::size_t>(n)])];
    }
    bool moves_with_rigid(Index n) const { return rigid_->nodes.row(node_[static_cast<std::size_t>(n)]) != no_index; }
    Index rigid_row(Index n) const { return rigid_->nodes.row(node_[static_cast<std::size_t>(n)]); }
    /// Vector from the centre of a rigid body to its node `n` [m]
    Vec3 arm(Index n) const {
        return rigid_->position[static_cast<std::size_t>(node_[static_cast<std::size_t>(n)])] -
               rigid_->center[body_of(n)];
    }
    /// True if the body is implicit and contacts touch its nodes. `body` is a row of RigidBodyTable.
    bool deforms(Index body) const {
        return implicit_->any() && !implicit_->coupling->nodes[static_cast<std::size_t>(body)].empty();
    }
    /// Velocity response of node `n` of an implicit body to an impulse on its node `m`, including rigid motion [1/kg]
    Mat3 response(Index n, Index m) const {
        const std::size_t r = body_of(m);
        const Mat3 turned = rigid_->spins.inverse_inertia[r] * cross_matrix(arm(m));
        return implicit_->coupling->block(r, touched_index(n), touched_index(m)) +
               rigid_->inverse_mass(r) * Mat3::Identity() - cross_matrix(arm(n)) * turned;
    }
    const ImplicitCoupling& deforming() const { return *implicit_->coupling; }
    /// Index of node `n` among the nodes of its implicit body that have contacts, or no_index.
    Index touched_index(Index n) const {
        const Index row = node_[static_cast<std::size_t>(n)] == no_index
                              ? no_index
                              : implicit_->row(node_[static_cast<std::size_t>(n)], rigid_->nodes);
        return row == no_index ? no_index : implicit_->coupling->touched_index[static_cast<std::size_t>(row)];
    }
    /// Row of RigidBodyTable of the body that owns node `n` (rigid, or implicit with its frame).
    std::size_t body_of(Index n) const {
        return static_cast<std::size_t>(rigid_->nodes.row(node_[static_cast<std::size_t>(n)]));
    }

private:
    Mat3 coupling_of(const LumpedContact& a, const LumpedContact& b, bool deformed) const {
        Mat3 sum = Mat3::Zero();
        Real lumped = 0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(a.node_count); ++k) {
            const Index index = touched_index(a.node[k]);
            Mat3 in_frame = Mat3::Zero();
            for (std::size_t l = 0; l < static_cast<std::size_t>(b.node_count); ++l) {
                const Index other = touched_index(b.node[l]);
                if (index == no_index && other == no_index)
                    lumped += clusters_.coupling_of_nodes(a, k, b, l);
                else if (deformed && index != no_index && other != no_index && body_of(a.node[k]) == body_of(b.node[l]))
                    in_frame += b.weight[l] * implicit_->coupling->block_in_frame(body_of(b.node[l]), index, other);
            }
            if (deformed && index != no_index)
                sum += a.weight[k] * implicit_->coupling->to_world(body_of(a.node[k]), in_frame);
        }
        return sum + lumped * Mat3::Identity();
    }

    ThroughClusters clusters_;
    const ImplicitInputs* implicit_;
    const RigidInputs* rigid_;
    std::span<const Index> node_;
};

}  // namespace skerry
