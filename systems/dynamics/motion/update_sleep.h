// Sleep of bodies: a body that has been slow for a while falls asleep together with all bodies that it touches. A
// sleeping body wakes when an awake body touches it (docs/methods/skipping.md 3).
#pragma once

#include <cstdint>
#include <span>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/column.h"
#include "components/contact_table.h"
#include "components/ghost_marks.h"
#include "components/implicit_node_table.h"
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
    Real speed = 0;           // speed limit: a body is still while all of its nodes are slower [m/s]
    bool own_limits = false;  // true: the engine uses own_sleep_limits (stillness.h) instead of `speed`
    Real time = 0.5;          // time for which a body and all bodies that it touches must be still [s]
    Real gravity = 0;         // [m/s^2]

    bool on() const { return speed > 0 || (own_limits && gravity > 0); }
};

/// Contacts of this step after the solve, and bodies that are connected, for example by joints (BodyLinks).
struct TouchInputs {
    std::span<const Index> first_body, second_body;
    std::span<const ContactState> state;
    std::span<const Real> gap;                               // [m]
    std::span<const Vec3> surface_velocity;                  // [m/s]
    std::span<const Index> linked_first{}, linked_second{};  // BodyLinks

    static TouchInputs bind(const Binder& binder, const ContactTable& contact, const BodyLinks& link) {
        return {.first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .state = binder.read(contact.state),
                .gap = binder.read(contact.gap),
                .surface_velocity = binder.read(contact.surface_velocity),
                .linked_first = binder.read(link.first),
                .linked_second = binder.read(link.second)};
    }
};

/// Inputs of the wake-up test: contacts of this step before the solve.
struct PressInputs {
    std::span<const Index> first_body, second_body;
    std::span<const Vec3> warm_impulse;    // impulses of earlier steps; empty if none are stored [N s]
    std::span<const std::uint8_t> asleep;  // by body

    static PressInputs bind(const Binder& binder, const ContactTable& contact, const BodyTable& body,
                            const WarmStart& warm_start) {
        return {.first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .warm_impulse = binder.read_if(binder.value(warm_start) == WarmStart::on, contact.impulse),
                .asleep = binder.read(body.asleep)};
    }
};

/// Marks both bodies of every contact with a stored impulse, for sleeping bodies that of the step in which they fell
/// asleep. The present solve would not show that such a contact is pressed, because it leaves out the weight of
/// sleeping bodies. If no impulses are stored, every contact counts.
void mark_pressed(const PressInputs& contacts, Column<std::uint8_t>& pressed);

/// Wakes a body in each of these cases:
/// - It is marked in `pressed` or `driven`.
/// - One of its contacts in this step has an impulse or a negative gap.
/// - BodyLinks connects it to an awake body.
/// - An attachment moves it.
///
/// Contacts between sleeping bodies are not searched, so each contact has an awake body or a moving collider. Returns
/// false if no body was woken.
bool wake_bodies(const TouchInputs& touches, std::span<const std::uint8_t> pressed,
                 std::span<const std::uint8_t> driven, std::span<const Index> attached_body,
                 std::span<const RigidMotion> attached_motion, std::span<std::uint8_t> asleep,
                 std::span<Real> still_time);

struct RestInputs {
    std::span<const Index> attached_body;  // by attachment
    std::span<const RigidMotion> attached_motion;
    std::span<const BodyKind> kind;
    std::span<const Range> nodes;
    std::span<const Real> mean_edge;  // [m]
    std::span<const Real> max_speed;  // greatest node speed in this step [m/s]
    std::span<const Index> material;  // row of MaterialTable, or no_index without a material
    std::span<const Index> pinned_count;
    std::span<const Real> material_damping;  // [1/s]
    std::span<const Vec3> position;          // by node, at the end of the step [m]
    std::span<const Vec3> rest_position;     // by node [m]
    std::span<const Real> mass;              // by node [kg]
    std::span<const Real> inverse_mass;      // by node [1/kg]
    // Columns of BodyTable and RigidBodyTable:
    std::span<const Range> body_rigid = {};     // empty if no body is rigid
    std::span<const Range> body_implicit = {};  // rows of ImplicitNodeTable
    std::span<const Index> rigid_body = {};
    std::span<const Real> rigid_mass = {};
    std::span<const Vec3> rigid_moments = {};
    std::span<const Mat3> rigid_rotation = {};
    std::span<const Index> rigid_holder = {};  // empty if no body is held
    std::span<const Index> body_core_nodes = {};
    // For each body, nonzero if a load, motor, spring, cable, cavity or family of fibres that acts on the body changes
    // in this step. May be empty.
    std::span<const std::uint8_t> driven = {};
    GhostMarks ghosts = {};

    static RestInputs bind(const Binder& binder, const AttachmentTable& attachment, const BodyTable& body,
                           const MaterialTable& material, const NodeTable& node, const RigidBodyTable& rigid,
                           const Column<std::uint8_t>& driven) {
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
                .body_core_nodes = binder.read(body.core_nodes),
                .driven = binder.read(driven),
                .ghosts = {binder.read(body.ghost)}};
    }

    /// Nodes that show whether the body moves. Nodes of a round body that are only drawn may be out of date and are
    /// left out.
    Range measured_nodes(std::size_t b) const {
        return body_core_nodes.empty() ? nodes[b] : step_nodes_of(nodes[b], body_core_nodes[b]);
    }
    /// Row of RigidBodyTable; no_index for a body that is neither rigid nor implicit.
    Index rigid(std::size_t b) const {
        return body_rigid.empty() || body_rigid[b].size() == 0 ? no_index : body_rigid[b].begin;
    }
    /// True if an attachment holds the body in the row `rigid` of RigidBodyTable.
    bool held(Index rigid) const {
        return !rigid_holder.empty() && rigid_holder[static_cast<std::size_t>(rigid)] != no_index;
    }
};

struct RestOutputs {
    std::span<std::uint8_t> asleep;                        // by body
    std::span<Real> still_time;                            // by body [s]
    std::span<Real> drift, drift_before;                   // by body [m]
    std::span<Real> shape_drift, creep_before;             // by body [m]
    std::span<Vec3> still_position;                        // by node [m]
    std::span<Vec3> velocity, velocity_next;               // by node [m/s]
    std::span<Vec3> momentum = {}, angular_momentum = {};  // RigidBodyTable
    std::span<Vec3> deforming = {};                        // ImplicitNodeTable [m/s]

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

/// Energy and momentum removed from the bodies that fall asleep in this step, without ghosts (copies of bodies of other
/// ranks). `bodies`: number of all bodies that fall asleep, with ghosts.
struct SleepLosses {
    Real energy = 0;               // kinetic energy [J]
    Vec3 momentum = Vec3::Zero();  // [kg m/s]
    Index bodies = 0;
};

struct SleepMemory {
    bool any_ready = false;  // true if a body has been still long enough; otherwise there are no sets
    UnionFind touching;      // sets of bodies that touch each other
    // For each body: nonzero if the body must stay awake. For the root of a set: nonzero if any body of the set must.
    Column<std::uint8_t> stays_awake;
};

/// Counts the time for which each body has been still. Once a body has been still long enough, finds the sets of bodies
/// that touch each other, directly or through other bodies. A set must stay awake if one of its bodies
/// - has not been still long enough,
/// - touches a moving collider,
/// - is held by a moving attachment, or
/// - is marked in `driven`.
///
/// Parallel over bodies; sequential over contacts once a body has been still long enough.
void find_still_sets(Executor& executor, const TouchInputs& touches, const RestInputs& bodies,
                     const SleepSettings& settings, Real h, SleepMemory& memory, const RestOutputs& state);

/// Stops the bodies of each set and puts them to sleep, unless the set must stay awake.
SleepLosses rest_bodies(const RestInputs& bodies, SleepMemory& memory, const RestOutputs& state);

}  // namespace skerry
