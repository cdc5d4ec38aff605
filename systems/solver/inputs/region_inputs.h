// What the stage solve_regions reads and writes, as spans.
#pragma once

#include <span>

#include "components/contact_table.h"
#include "components/implicit_coupling.h"
#include "components/implicit_node_table.h"
#include "components/joint_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "components/types.h"
#include "jobs/access.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// Rigid bodies at the start of the step, kicked. By row of RigidBodyTable, but for positions.
struct RigidInputs {
    RigidNodes nodes{};
    std::span<const Vec3> position{};  // m, by node
    std::span<const Vec3> center{};
    std::span<const Real> mass{};
    RigidSpins spins{};
    std::span<const Vec3> momentum{}, kick{};
    std::span<const Vec3> moments{};
    std::span<const Mat3> rotation{};
    std::span<const Index> body{}, core_nodes{};  // row of BodyTable; BodyTable
    // AttachmentTable, or no_index; empty: none is held. What deforms in a frame that is held has rows that stand still
    // for that, and its nodes all of their velocity (docs/methods/implicit_bodies.md 7)
    std::span<const Index> holder{};

    bool any() const { return nodes.any(); }
    /// 1/kg
    Real inverse_mass(std::size_t r) const { return holder.empty() || holder[r] == no_index ? 1 / mass[r] : 0; }
    Vec3 velocity(std::size_t r) const { return (momentum[r] + kick[r]) / mass[r]; }
    bool is_capsule(Index r) const { return core_of(r) == 2; }
    bool is_cylinder(Index r) const { return core_of(r) == cylinder_core_nodes; }
    /// m, of one that is round
    Real radius(Index r) const {
        return nodes.round_radius[static_cast<std::size_t>(body[static_cast<std::size_t>(r)])];
    }

    /// Nodes, of a row of RigidBodyTable.
    Index core_of(Index r) const {
        return core_nodes.empty() ? 0 : core_nodes[static_cast<std::size_t>(body[static_cast<std::size_t>(r)])];
    }

    static RigidInputs bind(const Binder& binder, const NodeTable& node, const BodyTable& body,
                            const RigidBodyTable& rigid) {
        const bool any = !binder.read(rigid.mass).empty();
        return {.nodes = RigidNodes::bind(binder, node, body, rigid),
                .position = binder.read(node.position),
                .center = binder.read(rigid.center),
                .mass = binder.read(rigid.mass),
                .spins = RigidSpins::bind(binder, rigid),
                .momentum = binder.read(rigid.momentum),
                .kick = binder.read(rigid.kick),
                .moments = binder.read(rigid.moments),
                .rotation = binder.read(rigid.rotation),
                .body = binder.read(rigid.body),
                .core_nodes = binder.read_if(any, body.core_nodes),
                .holder = binder.read(rigid.holder)};
    }
};

/// Bodies that move implicitly: what deforms in their frames, which are among the rigid bodies.
struct ImplicitInputs {
    std::span<const Range> body_implicit{};      // BodyTable
    const ImplicitCoupling* coupling = nullptr;  // null, or without nodes: contacts touch none
    // ImplicitNodeTable, m/s, in the frame of the mesh: kicked, and at the start of the step
    std::span<const Vec3> velocity{}, velocity_before{};
    std::span<const Mat3> axes{}, rotation{};  // RigidBodyTable

    static ImplicitInputs bind(const Binder& binder, const BodyTable& body, const RigidBodyTable& rigid,
                               const ImplicitNodeTable& implicit, const ImplicitCoupling& coupling) {
        return {.body_implicit = binder.read(body.implicit),
                .coupling = &binder.read(coupling),
                .velocity = binder.read(implicit.velocity_next),
                .velocity_before = binder.read(implicit.velocity),
                .axes = binder.read(rigid.axes),
                .rotation = binder.read(rigid.rotation)};
    }

    bool any() const { return coupling != nullptr && coupling->nodes.size() > 0; }
    /// Row of ImplicitNodeTable, or no_index.
    Index row(Index node, const RigidNodes& nodes) const {
        if (!any()) return no_index;
        const auto body = static_cast<std::size_t>(nodes.node_body[static_cast<std::size_t>(node)]);
        const Range rows = body_implicit[body];
        return rows.size() == 0 ? no_index : rows.begin + node - nodes.body_nodes[body].begin;
    }
    /// m/s, world: beside the motion of the frame. `row`: of ImplicitNodeTable; `body`: of RigidBodyTable.
    Vec3 deforming(Index row, Index body) const {
        const auto r = static_cast<std::size_t>(body);
        return rotation[r] * (axes[r].transpose() * velocity[static_cast<std::size_t>(row)]);
    }
    /// m/s, world: what the elasticity of its body gave a node in the kick, which contacts take back where it is in
    /// equilibrium with them.
    Vec3 thrown(Index node, const RigidNodes& nodes) const {
        const Index row = this->row(node, nodes);
        if (row == no_index) return Vec3::Zero();
        const auto r = static_cast<std::size_t>(nodes.row(node)), at = static_cast<std::size_t>(row);
        return rotation[r] * (axes[r].transpose() * (velocity[at] - velocity_before[at]));
    }
};

/// What the stage reads beside the contacts.
struct RegionInputs {
    std::span<const Stencil> stencil;
    std::span<const Vec3> normal;
    std::span<const Real> gap;
    std::span<const Vec3> surface_velocity;
    std::span<const Real> static_friction, dynamic_friction, restitution;
    std::span<const Real> inverse_mass;  // by node
    std::span<const Vec3> velocity;      // by node, at the start of the step
    Real gravity = 0;                    // m/s^2, norm: scale of the error measure
    // ascending; names the regions across steps. Without it there is no history to schedule by
    std::span<const ContactKey> key{};
    const NodeClusters* clusters = nullptr;  // nodes that move together; none, or null: every node by its own mass
    std::span<const Vec3> cluster_kick{};    // N s, of this step, by item of clusters->nodes
    RigidInputs rigid{};                     // bodies that move as a whole; none by default
    ImplicitInputs implicit{};               // those of them that deform; none by default
    std::span<const JointBlock> joints{};    // of rigid bodies; none by default
    // rows of BodyTable that a contact joins, or no_index; and by body. Empty: nobody knows what is still
    std::span<const Index> first_body{}, second_body{};
    std::span<const BodyKind> body_kind{};
    std::span<const Real> still_time{};  // s
    TouchPlaces touch{};                 // of cylinders

    bool clustered() const { return clusters != nullptr && !clusters->empty(); }

    /// `velocity`: of the nodes, at the start of the step.
    static RegionInputs bind(const Binder& binder, const ContactTable& contact, const NodeTable& node,
                             const Column<Vec3>& velocity, const Real& gravity, const NodeClusters& clusters,
                             const Column<Vec3>& cluster_kick, const BodyTable& body, const RigidBodyTable& rigid,
                             const ImplicitNodeTable& implicit, const ImplicitCoupling& coupling,
                             const JointBlockTable& joints) {
        return {.stencil = binder.read(contact.stencil),
                .normal = binder.read(contact.normal),
                .gap = binder.read(contact.gap),
                .surface_velocity = binder.read(contact.surface_velocity),
                .static_friction = binder.read(contact.static_friction),
                .dynamic_friction = binder.read(contact.dynamic_friction),
                .restitution = binder.read(contact.restitution),
                .inverse_mass = binder.read(node.inverse_mass),
                .velocity = binder.read(velocity),
                .gravity = binder.value(gravity),
                .key = binder.read(contact.key),
                .clusters = &binder.read(clusters),
                .cluster_kick = binder.read(cluster_kick),
                .rigid = RigidInputs::bind(binder, node, body, rigid),
                .implicit = ImplicitInputs::bind(binder, body, rigid, implicit, coupling),
                .joints = binder.read(joints.block),
                .first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .body_kind = binder.read(body.kind),
                .still_time = binder.read(body.still_time),
                .touch = TouchPlaces::bind(binder, contact)};
    }
};

struct RegionOutputs {
    std::span<Vec3> impulse;        // by contact: warm start in, solution out
    std::span<Vec3> velocity_next;  // by node: predicted in, solved out
    std::span<Vec3> push_out;       // by node, but for those of rigid bodies
    // by row of RigidBodyTable, from zero
    std::span<Vec3> contact_impulse{}, contact_moment{}, push_velocity{}, push_spin{};
    std::span<Vec3> deforming_impulse{};  // N s, by row of ImplicitNodeTable, from zero
    std::span<Vec3> joint_impulse{};      // by joint block: warm start in, solution out

    static RegionOutputs bind(const Binder& binder, ContactTable& contact, NodeTable& node, RigidBodyTable& rigid,
                              ImplicitNodeTable& implicit, JointBlockTable& joints) {
        return {.impulse = binder.write(contact.impulse),
                .velocity_next = binder.write(node.velocity_next),
                .push_out = binder.write(node.push_out),
                .contact_impulse = binder.write(rigid.contact_impulse),
                .contact_moment = binder.write(rigid.contact_moment),
                .push_velocity = binder.write(rigid.push_velocity),
                .push_spin = binder.write(rigid.push_spin),
                .deforming_impulse = binder.write(implicit.contact_impulse),
                .joint_impulse = binder.write(joints.impulse)};
    }
};

}  // namespace skerry
