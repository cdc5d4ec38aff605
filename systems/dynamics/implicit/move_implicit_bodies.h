// What deforms in the frame of a body that moves implicitly: kicked by forces, coupled where contacts touch it,
// strained once they are solved. Its frame moves as rigid bodies do (docs/methods/implicit_bodies.md 2, 4).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/contact_table.h"
#include "components/implicit_coupling.h"
#include "components/implicit_node_table.h"
#include "components/material_table.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/dynamics/implicit/stiff_body.h"
#include "systems/dynamics/rigid/held_bodies.h"

namespace skerry {

/// By row of RigidBodyTable; empty where a body does not deform.
using StiffBodies = std::vector<StiffBody>;

struct ImplicitBodies {
    std::span<const Index> body;                // RigidBodyTable
    std::span<const Mat3> axes, rotation;       // RigidBodyTable
    std::span<const std::uint8_t> large;        // RigidBodyTable
    std::span<const Range> body_nodes;          // BodyTable
    std::span<const Range> body_implicit;       // BodyTable
    std::span<const Index> body_material;       // BodyTable
    std::span<const std::uint8_t> body_asleep;  // BodyTable; empty: none is
    std::span<const Real> material_damping;     // 1/s
    std::span<const Vec3> displacement;         // m
    std::span<const Vec3> velocity;             // m/s
    std::span<const Vec3> left;                 // m, ImplicitNodeTable
    // Of those that attachments hold:
    RigidHolds holds;
    std::span<const Vec3> center, rest_center;           // RigidBodyTable
    std::span<const Vec3> rest_position, node_velocity;  // NodeTable: held nodes have what leads them
    std::span<const Real> inverse_mass;                  // NodeTable

    static ImplicitBodies bind(const Binder& binder, const RigidBodyTable& rigid, const BodyTable& of_body,
                               const MaterialTable& material, const ImplicitNodeTable& node, const NodeTable& all_nodes,
                               const AttachmentTable& attachment, const bool& any_asleep) {
        return {.body = binder.read(rigid.body),
                .axes = binder.read(rigid.axes),
                .rotation = binder.read(rigid.rotation),
                .large = binder.read(rigid.large),
                .body_nodes = binder.read(of_body.nodes),
                .body_implicit = binder.read(of_body.implicit),
                .body_material = binder.read(of_body.material),
                .body_asleep = binder.read_if(binder.value(any_asleep), of_body.asleep),
                .material_damping = binder.read(material.damping),
                .displacement = binder.read(node.displacement),
                .velocity = binder.read(node.velocity),
                .left = binder.read(node.left),
                .holds = RigidHolds::bind(binder, rigid, attachment),
                .center = binder.read(rigid.center),
                .rest_center = binder.read(rigid.rest_center),
                .rest_position = binder.read(all_nodes.rest_position),
                .node_velocity = binder.read(all_nodes.velocity),
                .inverse_mass = binder.read(all_nodes.inverse_mass)};
    }

    bool any() const { return !displacement.empty(); }
    /// Rows of ImplicitNodeTable of a row of RigidBodyTable; none where it does not deform.
    Range rows(std::size_t r) const { return body_implicit[static_cast<std::size_t>(body[r])]; }
    Range nodes(std::size_t r) const { return body_nodes[static_cast<std::size_t>(body[r])]; }
    bool asleep(std::size_t r) const {
        return !body_asleep.empty() && body_asleep[static_cast<std::size_t>(body[r])] != 0;
    }
    /// 1/s
    Real damping(std::size_t r) const {
        return material_damping[static_cast<std::size_t>(body_material[static_cast<std::size_t>(body[r])])];
    }
    /// Frame of the mesh to the world.
    Mat3 turn(std::size_t r) const { return rotation[r] * axes[r].transpose(); }
};

/// A step that implicit bodies of small strain take while others take several.
struct LongStepTimes {
    Real length = 0;      // s; 0: there is none, all take the same step
    bool starts = false;  // with this short step
    bool ends = false;    // with this short step
};

/// How long the step is.
struct ImplicitTimes : LongStepTimes {
    Real h = 0;  // s
    Real theta = 1;

    static ImplicitTimes bind(const Binder& binder, const Real& h, const Real& theta, const LongStepTimes& long_step) {
        ImplicitTimes times{binder.value(long_step)};
        times.h = binder.value(h);
        times.theta = binder.value(theta);
        return times;
    }
};

struct ImplicitLoads {
    std::span<const Vec3> load;  // N, by node; empty: none
    Vec3 gravity;                // m/s^2: of bodies that are held; others fall with their frames
    Real kick;                   // s, for which loads act on all others; on implicit bodies as long as the step is

    static ImplicitLoads bind(const Binder& binder, const NodeTable& node, const Vec3& gravity, const bool& loaded,
                              const Real& kick) {
        return {.load = binder.read_if(binder.value(loaded), node.load),
                .gravity = binder.value(gravity),
                .kick = binder.value(kick)};
    }
};

/// How the frames of bodies that nothing holds turn: RigidBodyTable.
struct ImplicitSpins {
    std::span<const Vec3> moments, angular_momentum, moment_kick, contact_moment, push_spin;

    static ImplicitSpins bind(const Binder& binder, const RigidBodyTable& rigid) {
        return {.moments = binder.read(rigid.moments),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .moment_kick = binder.read(rigid.moment_kick),
                .contact_moment = binder.read(rigid.contact_moment),
                .push_spin = binder.read(rigid.push_spin)};
    }

    /// kg m^2/s, in the world, without contacts and with them.
    Vec3 kicked(std::size_t r) const { return angular_momentum[r] + moment_kick[r]; }
    Vec3 after(std::size_t r) const { return angular_momentum[r] + (moment_kick[r] + contact_moment[r]); }
};

struct ImplicitKicks {
    std::span<Vec3> elastic_force, impulse, velocity_next, contact_impulse;  // ImplicitNodeTable
    std::span<Vec3> node_velocity_next;                                      // m/s, by node

    static ImplicitKicks bind(const Binder& binder, ImplicitNodeTable& implicit, NodeTable& node) {
        return {.elastic_force = binder.write(implicit.elastic_force),
                .impulse = binder.write(implicit.impulse),
                .velocity_next = binder.write(implicit.velocity_next),
                .contact_impulse = binder.write(implicit.contact_impulse),
                .node_velocity_next = binder.write(node.velocity_next)};
    }
};

/// velocity_next = A^-1 P (M w + theta h (Q^T f - K u)), or by Newton's method where strain is large, the velocity of
/// the step's displacement, to which kick_rigid_bodies has come first: nodes get what is added to their motion with the
/// frame. Factors of this step's length are made where they are not there. Of a body that is held velocities are those
/// in the world, and turned into the frame of its start; its held nodes have theirs already. Parallel over bodies.
/// Returns false where there is none (skipped).
bool kick_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const ImplicitLoads& loads,
                          const ImplicitSpins& spins, const ImplicitTimes& times, StiffBodies& stiff,
                          const ImplicitKicks& out);

/// Lists the nodes that contacts touch, and what impulses on them do to each other. Returns false where no contact
/// touches an implicit body (skipped).
bool couple_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, std::span<const Stencil> stencil,
                            std::span<const Index> node_body, const ImplicitTimes& times, StiffBodies& stiff,
                            ImplicitCoupling& coupling);

struct ImplicitStrains {
    std::span<const Vec3> elastic_force, contact_impulse;                   // ImplicitNodeTable
    std::span<Vec3> impulse, force_rate, velocity_next, displacement_next;  // ImplicitNodeTable
    // RigidBodyTable:
    std::span<Vec3> hold_moment, moments_next;
    std::span<Mat3> axes_next, rotation_shaped;
    std::span<std::uint8_t> large_next;
    std::span<Vec3> force;  // N, by node: of held ones

    static ImplicitStrains bind(const Binder& binder, ImplicitNodeTable& implicit, RigidBodyTable& rigid,
                                NodeTable& node) {
        return {.elastic_force = binder.read(implicit.elastic_force),
                .contact_impulse = binder.read(implicit.contact_impulse),
                .impulse = binder.write(implicit.impulse),
                .force_rate = binder.write(implicit.force_rate),
                .velocity_next = binder.write(implicit.velocity_next),
                .displacement_next = binder.write(implicit.displacement_next),
                .hold_moment = binder.write(rigid.hold_moment),
                .moments_next = binder.write(rigid.moments_next),
                .axes_next = binder.write(rigid.axes_next),
                .rotation_shaped = binder.write(rigid.rotation_shaped),
                .large_next = binder.write(rigid.large_next),
                .force = binder.write(node.force)};
    }
};

/// What the step of one body did.
struct StrainPart {
    Real damped = 0;  // J, less what holds by their moments gave
    // N s, of weight and loads: over the step less over the time for which they act on other bodies
    Vec3 impulse = Vec3::Zero();
};

struct StrainFindings {
    Real damped = 0;  // sums over the bodies
    Vec3 impulse = Vec3::Zero();
    NewtonCounts newton;
    Index unsolved = no_index;  // row of BodyTable: the first whose step of large strain was not found
};

/// The velocities and displacements at the end of the step, and what elasticity does to held nodes and frames, added to
/// `force`, which then acts for `loads.kick`, and written to `hold_moment`. `parts` is memory, by row of
/// RigidBodyTable. Parallel over bodies.
StrainFindings strain_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const ImplicitLoads& loads,
                                      const ImplicitSpins& spins, const ImplicitTimes& times, StiffBodies& stiff,
                                      const ImplicitStrains& out, Column<StrainPart>& parts);

/// When a short step is taken: bodies in a long step have come so far in it. `left`: m, ImplicitNodeTable.
void carry_long_steps(const ImplicitTimes& times, std::span<const Index> body, std::span<const Range> body_implicit,
                      StiffBodies& stiff, std::span<Vec3> left);

/// What deforms goes on for `seconds` with the velocity that it has. Writes what ElasticMotion reads.
void drift_implicit_bodies(const ImplicitBodies& bodies, const ImplicitSpins& spins, StiffBodies& stiff, Real seconds,
                           const ImplicitStrains& out);

}  // namespace skerry
