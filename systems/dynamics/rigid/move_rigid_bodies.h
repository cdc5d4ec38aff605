// Three stages of a step of rigid bodies: forces change the momenta, the solved contacts give the rotation and
// position, and the committed step stores the new state (docs/methods/rigid_bodies.md 2).
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

/// Properties of rigid bodies, and the state of these bodies at the start of the step. Implicit bodies are included:
/// the frame of the mesh and the centre of mass of an implicit body move like a rigid body.
struct RigidBodies {
    std::span<const Index> body;
    std::span<const Range> body_nodes;     // BodyTable
    std::span<const Range> body_implicit;  // BodyTable
    // for round bodies (spheres, capsules, cylinders): number of nodes that take part in the step; empty: all nodes do
    std::span<const Index> body_core_nodes;
    std::span<const std::uint8_t> body_asleep;  // column of BodyTable; empty if no body is asleep
    std::span<const Real> mass;
    std::span<const Vec3> moments, rest_center, center;
    std::span<const Mat3> axes, rotation;
    std::span<const Vec3> momentum, angular_momentum;
    std::span<const Vec3> rest_position;  // by node [m]
    std::span<const Real> inverse_mass;   // by node [1/kg]
    std::span<const Index> holder;        // row of AttachmentTable, or no_index if no attachment holds the body

    /// `forced`: true if the world has force elements. Then all nodes take part in the step, including nodes of round
    /// bodies that are only drawn.
    static RigidBodies bind(const Binder& binder, const RigidBodyTable& rigid, const BodyTable& of_body,
                            const NodeTable& node, const bool& any_asleep, const bool& forced) {
        return {.body = binder.read(rigid.body),
                .body_nodes = binder.read(of_body.nodes),
                .body_implicit = binder.read(of_body.implicit),
                .body_core_nodes = binder.read_if(!binder.value(forced), of_body.core_nodes),
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
    /// Nodes that need velocities before the step is committed. Nodes of a round body that are only drawn are left out.
    Range step_nodes(std::size_t r) const {
        return body_core_nodes.empty() ? nodes(r)
                                       : step_nodes_of(nodes(r), body_core_nodes[static_cast<std::size_t>(body[r])]);
    }
    /// Rows of the body in ImplicitNodeTable; empty for a rigid body.
    Range implicit(std::size_t r) const { return body_implicit[static_cast<std::size_t>(body[r])]; }
    /// True if row `r` is the frame of an implicit body that an attachment holds. All momentum of such a body is in the
    /// velocities of its nodes.
    bool is_led_frame(std::size_t r) const { return holder[r] != no_index && implicit(r).size() > 0; }
};

/// Deformation of implicit bodies at the end of the step, in the frames of their meshes, by row of ImplicitNodeTable.
struct ElasticMotion {
    std::span<const Vec3> displacement, velocity;  // [m], [m/s]
    // Columns of RigidBodyTable, used only for implicit bodies. `large`: 1 if the deformation is large.
    std::span<const std::uint8_t> large;
    std::span<const Vec3> moments;
    // `rotation`: from the principal frame of the new shape to the world, without the rigid rotation of this step
    std::span<const Mat3> axes, rotation;

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
    Vec3 gravity;                    // [m/s^2]
    std::span<const Vec3> load;      // applied force by node; empty if there are no applied forces [N]
    std::span<const Vec3> position;  // by node [m]

    /// `forced`: true if the world has force elements.
    static RigidForces bind(const Binder& binder, const NodeTable& node, const Vec3& gravity, const bool& forced) {
        return {.gravity = binder.value(gravity),
                .load = binder.read_if(binder.value(forced), node.applied_force),
                .position = binder.read(node.position)};
    }
};

struct RigidKicks {
    std::span<Vec3> kick, moment_kick;
    std::span<Mat3> inverse_inertia;
    std::span<Vec3> contact_impulse, contact_moment, push_velocity, push_spin;  // set to zero
    std::span<Vec3> velocity_next;                                              // by node [m/s]

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

/// Computes the impulse and angular impulse of gravity and loads on each body, and the node velocities after these
/// impulses, from which the contact solver starts. Parallel over bodies. Returns false if there is no rigid body
/// (skipped).
/// - Gravity and loads act for the force interval `kick` (docs/methods/time_stepping.md 1.5), but on the frames of
///   implicit bodies for the complete step `h`.
/// - Sleeping bodies get no impulse.
/// - A held rigid body gets the impulse that moves it with its attachment; drive_nodes has already set the velocities
///   of its nodes.
/// - The frame of a held implicit body has no momentum, because its motion is prescribed.
bool kick_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidHolds& holds,
                       const RigidForces& forces, Real h, Real kick, const RigidKicks& out);

/// Impulses of forces and contacts on rigid bodies in this step, and the velocities that push bodies out of overlaps.
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
    // For each node: constant velocity that leads to the end position, including push-out [m/s]
    std::span<Vec3> velocity_next;

    static RigidTurns bind(const Binder& binder, RigidBodyTable& rigid, NodeTable& node) {
        return {.center_next = binder.write(rigid.center_next),
                .rotation_next = binder.write(rigid.rotation_next),
                .velocity_next = binder.write(node.velocity_next)};
    }
};

/// Computes the poses of the bodies at the end of the step, and the constant node velocities that lead to these poses.
/// Parallel over bodies. Returns false if there is no rigid body (skipped).
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

/// Commits the step: awake bodies and their nodes get the poses `center_next` and `rotation_next` and the momenta at
/// the end of the step. With `draws_late` only the nodes step_nodes() of round bodies move; draw_round_bodies moves the
/// other nodes later. Parallel over bodies. Returns false if there is no rigid body (skipped).
bool move_rigid_bodies(Executor& executor, const RigidBodies& bodies, const RigidImpulses& impulses,
                       const ElasticMotion& elastic, std::span<const Vec3> center_next,
                       std::span<const Mat3> rotation_next, bool draws_late, const RigidMoves& out);

/// Moves those nodes of round bodies that only serve for drawing: they follow the present poses of the bodies. Nodes of
/// sleeping bodies move only with `resting`. Parallel over bodies.
void draw_round_bodies(Executor& executor, const RigidBodies& bodies, bool resting, std::span<Vec3> position,
                       std::span<Vec3> velocity);

}  // namespace skerry
