// Bodies that have been slow for a while are put to rest, all that touch each other at once; what touches them wakes
// them (docs/methods/skipping.md 3).
#pragma once

#include <cstdint>
#include <span>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/column.h"
#include "components/contact_table.h"
#include "components/implicit_node_table.h"
#include "components/joint_table.h"
#include "components/material_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "components/options.h"
#include "components/rigid_body_table.h"
#include "components/union_find.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct SleepSettings {
    Real speed = 0;           // m/s: a body is still while no node of it is as fast
    bool own_limits = false;  // or by own_sleep_limits (stillness.h)
    Real time = 0.5;          // s: so long a body has to be still, and all that it touches
    Real gravity = 0;         // m/s^2

    bool on() const { return speed > 0 || (own_limits && gravity > 0); }
};

/// The contacts of this step, after the solve.
struct TouchInputs {
    std::span<const Index> first_body, second_body;
    std::span<const ContactState> state;
    std::span<const Real> gap;                             // m
    std::span<const Vec3> surface_velocity;                // m/s
    std::span<const Index> joint_first{}, joint_second{};  // rows of BodyTable that a joint joins

    static TouchInputs bind(const Binder& binder, const ContactTable& contact, const JointTable& joint) {
        return {.first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .state = binder.read(contact.state),
                .gap = binder.read(contact.gap),
                .surface_velocity = binder.read(contact.surface_velocity),
                .joint_first = binder.read(joint.first),
                .joint_second = binder.read(joint.second)};
    }
};

/// The contacts of this step, before the solve.
struct PressInputs {
    std::span<const Index> first_body, second_body;
    std::span<const Vec3> warm_impulse;    // N s; empty: none is kept
    std::span<const std::uint8_t> asleep;  // by body

    static PressInputs bind(const Binder& binder, const ContactTable& contact, const BodyTable& body,
                            const WarmStart& warm_start) {
        return {.first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .warm_impulse = binder.read_if(binder.value(warm_start) == WarmStart::on, contact.impulse),
                .asleep = binder.read(body.asleep)};
    }
};

/// Marks bodies at rest that a contact has pressed on: by the impulse that it had when they were put to rest, since
/// without their weight they may not press now. Where no impulse is kept every contact counts.
void mark_pressed(const PressInputs& contacts, Column<std::uint8_t>& pressed);

/// Wakes every body that is marked, that a contact of this step presses on, by an impulse or by overlap, that is
/// joined to one that is awake, or that an attachment leads. Contacts between bodies at rest are not looked for, so
/// what presses moves. Returns false when none was woken.
bool wake_bodies(const TouchInputs& touches, std::span<const std::uint8_t> pressed,
                 std::span<const Index> attached_body, std::span<const RigidMotion> attached_motion,
                 std::span<std::uint8_t> asleep, std::span<Real> still_time);

struct RestInputs {
    std::span<const Index> attached_body;  // by attachment
    std::span<const RigidMotion> attached_motion;
    std::span<const BodyKind> kind;
    std::span<const Range> nodes;
    std::span<const Real> mean_edge;  // m
    std::span<const Real> max_speed;  // m/s, of this step
    std::span<const Index> material;  // row of MaterialTable or no_index
    std::span<const Index> pinned_count;
    std::span<const Real> material_damping;  // 1/s
    std::span<const Vec3> position;          // m, by node, at the end of the step
    std::span<const Vec3> rest_position;     // m, by node
    std::span<const Real> mass;              // kg, by node
    std::span<const Real> inverse_mass;      // 1/kg, by node
    // BodyTable, RigidBodyTable
    std::span<const Range> body_rigid = {};     // empty: none is
    std::span<const Range> body_implicit = {};  // of ImplicitNodeTable
    std::span<const Index> rigid_body = {};
    std::span<const Real> rigid_mass = {};
    std::span<const Vec3> rigid_moments = {};
    std::span<const Mat3> rigid_rotation = {};
    std::span<const Index> rigid_holder = {};  // empty: none is held
    std::span<const Index> body_core_nodes = {};

    static RestInputs bind(const Binder& binder, const AttachmentTable& attachment, const BodyTable& body,
                           const MaterialTable& material, const NodeTable& node, const RigidBodyTable& rigid) {
        return {.attached_body = binder.read(attachment.body),
                .attached_motion = binder.read(attachment.motion),
                .kind = binder.read(body.kind),
                .nodes = binder.read(body.nodes),
                .mean_edge = binder.read(body.mean_edge),
                .max_speed = binder.read(body.max_speed),
                .material = binder.read(body.material),
                .pinned_count = binder.read(body.pinned_count),
                .material_damping = binder.read(material.damping),
                .position = binder.read(node.position),
                .rest_position = binder.read(node.rest_position),
                .mass = binder.read(node.mass),
                .inverse_mass = binder.read(node.inverse_mass),
                .body_rigid = binder.read(body.rigid),
                .body_implicit = binder.read(body.implicit),
                .rigid_body = binder.read(rigid.body),
                .rigid_mass = binder.read(rigid.mass),
                .rigid_moments = binder.read(rigid.moments),
                .rigid_rotation = binder.read(rigid.rotation),
                .rigid_holder = binder.read(rigid.holder),
                .body_core_nodes = binder.read(body.core_nodes)};
    }

    /// Those that tell whether the body moves: nodes that only draw a round one may be behind.
    Range telling_nodes(std::size_t b) const {
        return body_core_nodes.empty() ? nodes[b] : step_nodes_of(nodes[b], body_core_nodes[b]);
    }
    /// Row of RigidBodyTable, or no_index.
    Index rigid(std::size_t b) const {
        return body_rigid.empty() || body_rigid[b].size() == 0 ? no_index : body_rigid[b].begin;
    }
    /// Whether an attachment leads what has this row of RigidBodyTable.
    bool held(Index rigid) const {
        return !rigid_holder.empty() && rigid_holder[static_cast<std::size_t>(rigid)] != no_index;
    }
};

struct RestOutputs {
    std::span<std::uint8_t> asleep;                        // by body
    std::span<Real> still_time;                            // s, by body
    std::span<Real> drift, drift_before;                   // m, by body
    std::span<Real> shape_drift, creep_before;             // m, by body
    std::span<Vec3> still_position;                        // m, by node
    std::span<Vec3> velocity, velocity_next;               // m/s, by node
    std::span<Vec3> momentum = {}, angular_momentum = {};  // of rigid bodies
    std::span<Vec3> deforming = {};                        // m/s, of implicit bodies

    static RestOutputs bind(const Binder& binder, BodyTable& body, NodeTable& node, RigidBodyTable& rigid,
                            ImplicitNodeTable& implicit) {
        return {.asleep = binder.write(body.asleep),
                .still_time = binder.write(body.still_time),
                .drift = binder.write(body.drift),
                .drift_before = binder.write(body.drift_before),
                .shape_drift = binder.write(body.shape_drift),
                .creep_before = binder.write(body.creep_before),
                .still_position = binder.write(node.still_position),
                .velocity = binder.write(node.velocity),
                .velocity_next = binder.write(node.velocity_next),
                .momentum = binder.write(rigid.momentum),
                .angular_momentum = binder.write(rigid.angular_momentum),
                .deforming = binder.write(implicit.velocity)};
    }
};

/// What rest took from the bodies that were put to it in this step.
struct TakenByRest {
    Real energy = 0;               // J, kinetic
    Vec3 momentum = Vec3::Zero();  // kg m/s
    Index bodies = 0;
};

struct SleepMemory {
    UnionFind touching;             // bodies
    Column<std::uint8_t> restless;  // by body
};

/// Counts for how long each body has been still, and puts those to rest that are still with all that they touch,
/// directly or through others: their velocities become zero. What touches a collider, or is held by an attachment, that
/// moves stays awake.
/// Parallel over bodies; sequential over contacts when a body is ready.
TakenByRest rest_bodies(Executor& executor, const TouchInputs& touches, const RestInputs& bodies,
                        const SleepSettings& settings, Real h, SleepMemory& memory, const RestOutputs& state);

}  // namespace skerry
