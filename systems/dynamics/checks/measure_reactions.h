// Measures the impulses of attachments on their bodies in a step.
#pragma once

#include <cstdint>
#include <span>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/column.h"
#include "components/element_table.h"
#include "components/material_table.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"

namespace skerry {

struct ImpulseAndMoment {
    Vec3 impulse = Vec3::Zero();  // N s
    Vec3 moment = Vec3::Zero();   // N m s

    ImpulseAndMoment& operator+=(const ImpulseAndMoment& more) {
        impulse += more.impulse;
        moment += more.moment;
        return *this;
    }
};

struct ReactionInputs {
    std::span<const Range> attached;       // by attachment: range of entries in `held`
    std::span<const Index> attached_body;  // by attachment: row of BodyTable of the attached body
    std::span<const Index> held;           // held nodes of all attachments: rows of NodeTable
    std::span<const Mat3> directions;      // AttachmentTable::held
    std::span<const Vec3> axis_impulse;    // impulses that hold_axes applied, by entry of `held` [N s]
    std::span<const Vec3> held_impulse;    // impulse of contacts on held nodes, by node [N s]
    // velocity of each held node after the previous step [m/s]; `velocity` already holds the velocity prescribed for
    // this step
    std::span<const Vec3> velocity_before;
    // by node
    std::span<const Vec3> position, velocity, velocity_next;
    std::span<const Vec3> force;
    std::span<const Real> mass, inverse_mass;
    // by body
    std::span<const std::uint8_t> asleep;
    std::span<const BodyKind> kind;
    std::span<const Range> blocks;
    std::span<const Real> cluster_step;  // longest stable step of the implicit elements; 0 if there are none [s]
    std::span<const Index> body_material;
    std::span<const Real> material_damping;  // 1/s
    // by element block
    std::span<const ElementLane> implicit_modulus, volume;
    std::span<const Index> first, count;
    std::span<const NodeLane> element_node;
    std::span<const ElementGradient> gradient;
    // `body_rigid`, `body_implicit`: rows of RigidBodyTable and of ImplicitNodeTable that belong to each body. The
    // other spans are columns of RigidBodyTable. For a rigid body that an attachment holds, `kick` and `moment_kick`
    // are the changes of its momentum and angular momentum.
    std::span<const Range> body_rigid, body_implicit;  // BodyTable
    std::span<const Index> holder;
    std::span<const Vec3> center, kick, moment_kick, hold_moment;

    static ReactionInputs bind(const Binder& binder, const AttachmentTable& attachment, const NodeTable& node,
                               const BodyTable& body, const MaterialTable& material, const ElementBlockTable& element,
                               const ElementNodeTable& nodes, const RigidBodyTable& rigid,
                               const Column<Vec3>& axis_impulse, const Column<Vec3>& held_impulse,
                               const Column<Vec3>& velocity_before) {
        return {.attached = binder.read(attachment.nodes),
                .attached_body = binder.read(attachment.body),
                .held = binder.read(attachment.node),
                .directions = binder.read(attachment.held),
                .axis_impulse = binder.read(axis_impulse),
                .held_impulse = binder.read(held_impulse),
                .velocity_before = binder.read(velocity_before),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .velocity_next = binder.read(node.velocity_next),
                .force = binder.read(node.force),
                .mass = binder.read(node.mass),
                .inverse_mass = binder.read(node.inverse_mass),
                .asleep = binder.read(body.asleep),
                .kind = binder.read(body.kind),
                .blocks = binder.read(body.blocks),
                .cluster_step = binder.read(body.cluster_step),
                .body_material = binder.read(body.material),
                .material_damping = binder.read(material.damping),
                .implicit_modulus = binder.read(element.implicit_modulus),
                .volume = binder.read(element.volume),
                .first = binder.read(element.first),
                .count = binder.read(element.count),
                .element_node = binder.read(nodes.node),
                .gradient = binder.read(nodes.gradient),
                .body_rigid = binder.read(body.rigid),
                .body_implicit = binder.read(body.implicit),
                .holder = binder.read(rigid.holder),
                .center = binder.read(rigid.center),
                .kick = binder.read(rigid.kick),
                .moment_kick = binder.read(rigid.moment_kick),
                .hold_moment = binder.read(rigid.hold_moment)};
    }
};

/// Writes the impulse and moment of each attachment on its nodes, one row per attachment. Moments are about
/// `moment_point`. `kick`: time for which forces act [s]. `node_impulse`: work memory, by node. Sequential.
///
/// The impulse is the change of momentum of the nodes in this step, minus the impulses of element forces, weight, loads
/// and contacts. The momentum includes the inertia of implicit elements.
/// - If several attachments hold a node or a rigid body, the impulse counts for the last of them, whose motion the node
///   or body follows.
/// - Attachments of sleeping bodies and of colliders get rows of zeros.
void measure_reactions(const ReactionInputs& inputs, Real kick, const Vec3& moment_point, Column<Vec3>& node_impulse,
                       Column<ImpulseAndMoment>& reactions);

}  // namespace skerry
