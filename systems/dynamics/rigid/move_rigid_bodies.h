// The three stages of a step of rigid bodies: kicked by forces, turned once contacts are solved, and moved when the
// step is taken (docs/methods/rigid_bodies.md 2).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/implicit_node_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/rigid/held_bodies.h"

namespace skerry {

/// What rigid bodies are, and where they are at the start of the step. Those that move implicitly are among them: what
/// moves as a rigid body does is the frame of their mesh, and their centre of mass.
struct RigidBodies {
    std::span<const Index> body;
    std::span<const Range> body_nodes;          // BodyTable
    std::span<const Range> body_implicit;       // BodyTable
    std::span<const Index> body_core_nodes;     // BodyTable; empty: all nodes of round bodies are looked at, too
    std::span<const std::uint8_t> body_asleep;  // BodyTable; empty: none is
    std::span<const Real> mass;
    std::span<const Vec3> moments, rest_center, center;
    std::span<const Mat3> axes, rotation;
    std::span<const Vec3> momentum, angular_momentum;
    std::span<const Vec3> rest_position;  // m, by node
    std::span<const Real> inverse_mass;   // 1/kg, by node
    std::span<const Index> holder;        // AttachmentTable, or no_index

    /// `loaded`: some node has a load, so that what loads do is asked of every node.
    static RigidBodies bind(const Binder& binder, const RigidBodyTable& rigid, const BodyTable& of_body,
                            const NodeTable& node, const bool& any_asleep, const bool& loaded) {
        return {.body = binder.read(rigid.body),
                .body_nodes = binder.read(of_body.nodes),
                .body_implicit = binder.read(of_body.implicit),
                .body_core_nodes = binder.read_if(!binder.value(loaded), of_body.core_nodes),
                .body_asleep = binder.read_if(binder.value(any_asleep), of_body.asleep),
                .mass = binder.read(rigid.mass),
                .moments = binder.read(rigid.moments),
                .rest_center = binder.read(rigid.rest_center),
                .center = binder.read(rigid.center),
                .axes = binder.read(rigid.axes),
                .rotation = binder.read(rigid.rotation),
                .momentum = binder.read(rigid.momentum),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .rest_position = binder.read(node.rest_position),
                .inverse_mass = binder.read(node.inverse_mass),
                .holder = binder.read(rigid.holder)};
    }

    std::size_t size() const { return mass.size(); }
    bool asleep(std::size_t r) const {
        return !body_asleep.empty() && body_asleep[static_cast<std::size_t>(body[r])] != 0;
    }
    Range nodes(std::size_t r) const { return body_nodes[static_cast<std::size_t>(body[r])]; }
    /// Those whose velocities are asked for before the step is taken.
    Range step_nodes(std::size_t r) const {
        return body_core_nodes.empty() ? nodes(r)
                                       : step_nodes_of(nodes(r), body_core_nodes[static_cast<std::size_t>(body[r])]);
    }
    /// Rows of ImplicitNodeTable.
    Range implicit(std::size_t r) const { return body_implicit[static_cast<std::size_t>(body[r])]; }
    /// Whether it is a frame that an attachment leads, in which nodes have momenta of their own.
    bool is_led_frame(std::size_t r) const { return holder[r] != no_index && implicit(r).size() > 0; }
};

/// How implicit bodies are deformed at the end of the step, in the frames of their meshes: by row of ImplicitNodeTable.
struct ElasticMotion {
    std::span<const Vec3> displacement, velocity;  // m, m/s
    // RigidBodyTable, asked of what deforms alone:
    std::span<const std::uint8_t> large;
    std::span<const Vec3> moments;
    std::span<const Mat3> axes, rotation;  // before it is turned

    static ElasticMotion bind(const Binder& binder, const ImplicitNodeTable& implicit, const RigidBodyTable& rigid) {
        return {.displacement = binder.read(implicit.displacement_next),
                .velocity = binder.read(implicit.velocity_next),
                .large = binder.read(rigid.large_next),
                .moments = binder.read(rigid.moments_next),
                .axes = binder.read(rigid.axes_next),
                .rotation = binder.read(rigid.rotation_shaped)};
    }
};

struct RigidForces {
    Vec3 gravity;                    // m/s^2
    std::span<const Vec3> load;      // N, by node; empty: none
    std::span<const Vec3> position;  // m, by node

    /// `loaded`: some node has a load.
    static RigidForces bind(const Binder& binder, const NodeTable& node, const Vec3& gravity, const bool& loaded) {
        return {.gravity = binder.value(gravity),
                .load = binder.read_if(binder.value(loaded), node.load),
                .position = binder.read(node.position)};
    }
};

struct RigidKicks {
    std::span<Vec3> kick, moment_kick;
    std::span<Mat3> inverse_inertia;
    std::span<Vec3> contact_impulse, contact_moment, push_velocity, push_spin;  // set to zero
    std::span<Vec3> velocity_next;                                              // m/s, by node

    static RigidKicks bind(const Binder& binder, RigidBodyTable& rigid, NodeTable& node) {
        return {.kick = binder.write(rigid.kick),
                .moment_kick = binder.write(rigid.moment_kick),
                .inverse_inertia = binder.write(rigid.inverse_inertia),
                .contact_impulse = binder.write(rigid.contact_impulse),
                .contact_moment = binder.write(rigid.contact_moment),
                .push_velocity = binder.write(rigid.push_velocity),
                .push_spin = binder.write(rigid.push_spin),
                .velocity_next = binder.write(node.velocity_next)};
    }
};

/// The impulse and moment of gravity and loads, which act for `kick`, on frames of implicit bodies for the step, and
/// the velocities with them, as contacts see them. Those at rest get none, those that are held what takes them along:
/// their nodes have their velocities already. Frames that are held have neither momentum nor freedom. Parallel over
/// bodies. Returns false where there is none (skipped).
bool kick_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidHolds& holds,
                       const RigidForces& forces, Real h, Real kick, const RigidKicks& out);

/// What acted on rigid bodies in this step.
struct RigidImpulses {
    std::span<const Vec3> kick, moment_kick, contact_impulse, contact_moment, push_velocity, push_spin;

    static RigidImpulses bind(const Binder& binder, const RigidBodyTable& rigid) {
        return {.kick = binder.read(rigid.kick),
                .moment_kick = binder.read(rigid.moment_kick),
                .contact_impulse = binder.read(rigid.contact_impulse),
                .contact_moment = binder.read(rigid.contact_moment),
                .push_velocity = binder.read(rigid.push_velocity),
                .push_spin = binder.read(rigid.push_spin)};
    }
};

struct RigidTurns {
    std::span<Vec3> center_next;
    std::span<Mat3> rotation_next;
    std::span<Vec3> velocity_next;  // m/s, by node: of the straight way to where it will be, push-out included

    static RigidTurns bind(const Binder& binder, RigidBodyTable& rigid, NodeTable& node) {
        return {.center_next = binder.write(rigid.center_next),
                .rotation_next = binder.write(rigid.rotation_next),
                .velocity_next = binder.write(node.velocity_next)};
    }
};

/// Where the bodies are at the end of the step. Parallel over bodies. Returns false where there is none (skipped).
bool turn_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidHolds& holds,
                       const RigidImpulses& impulses, const ElasticMotion& elastic, std::span<const Vec3> position,
                       Real h, const RigidTurns& out);

struct RigidMoves {
    std::span<Vec3> center, momentum, angular_momentum, moments;
    std::span<Mat3> rotation, axes;
    std::span<Vec3> position, velocity;                   // by node
    std::span<Vec3> displacement, displacement_velocity;  // ImplicitNodeTable
    std::span<std::uint8_t> large;

    static RigidMoves bind(const Binder& binder, RigidBodyTable& rigid, NodeTable& node, ImplicitNodeTable& implicit) {
        return {.center = binder.write(rigid.center),
                .momentum = binder.write(rigid.momentum),
                .angular_momentum = binder.write(rigid.angular_momentum),
                .moments = binder.write(rigid.moments),
                .rotation = binder.write(rigid.rotation),
                .axes = binder.write(rigid.axes),
                .position = binder.write(node.position),
                .velocity = binder.write(node.velocity),
                .displacement = binder.write(implicit.displacement),
                .displacement_velocity = binder.write(implicit.velocity),
                .large = binder.write(rigid.large)};
    }
};

/// Commits: the bodies that do not rest, and their nodes, are where they were turned to (`center_next`,
/// `rotation_next`), and go on with the momenta that the step gave them; `draws_late`: of round bodies only step_nodes,
/// the others wait for draw_round_bodies. Parallel over bodies. Returns false where there is none (skipped).
bool move_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidImpulses& impulses,
                       const ElasticMotion& elastic, std::span<const Vec3> center_next,
                       std::span<const Mat3> rotation_next, bool draws_late, const RigidMoves& out);

/// Puts the nodes that only draw round bodies where they would be by now, also of those at rest where `resting`.
/// Parallel over bodies.
void draw_round_bodies(Executor& executor, const RigidBodies& bodies, bool resting, std::span<Vec3> position,
                       std::span<Vec3> velocity);

}  // namespace skerry
