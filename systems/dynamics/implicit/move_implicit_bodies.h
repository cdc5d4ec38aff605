// Deformation of implicit bodies in the frames of their meshes: forces change the velocities, contacts couple the
// touched nodes, and displacements follow after contacts are solved. The frames move like rigid bodies
// (docs/methods/implicit_bodies.md 2, 4).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/cable_table.h"
#include "components/contact_table.h"
#include "components/ghost_marks.h"
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

/// One StiffBody for each row of RigidBodyTable; a StiffBody is empty for a body that does not deform.
using StiffBodies = std::vector<StiffBody>;

struct ImplicitBodies {
    std::span<const Index> body;                // RigidBodyTable
    std::span<const Mat3> axes, rotation;       // RigidBodyTable
    std::span<const std::uint8_t> large;        // RigidBodyTable
    std::span<const Range> body_nodes;          // BodyTable
    std::span<const Range> body_implicit;       // BodyTable
    std::span<const Index> body_material;       // BodyTable
    std::span<const std::uint8_t> body_asleep;  // column of BodyTable; empty if no body is asleep
    std::span<const Real> material_damping;     // MaterialTable [1/s]
    std::span<const Vec3> displacement;         // ImplicitNodeTable [m]
    std::span<const Vec3> velocity;             // ImplicitNodeTable [m/s]
    std::span<const Vec3> left;                 // ImplicitNodeTable [m]
    // Columns for bodies that attachments hold:
    RigidHolds holds;
    std::span<const Vec3> center, rest_center;           // RigidBodyTable
    std::span<const Vec3> rest_position, node_velocity;  // NodeTable; velocities of held nodes are prescribed
    std::span<const Real> inverse_mass;                  // NodeTable
    GhostMarks ghosts = {};

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
                .inverse_mass = binder.read(all_nodes.inverse_mass),
                .ghosts = {binder.read(of_body.ghost)}};
    }

    bool any() const { return !displacement.empty(); }
    /// Rows of ImplicitNodeTable of the body in row `r` of RigidBodyTable; empty if the body does not deform.
    Range rows(std::size_t r) const { return body_implicit[static_cast<std::size_t>(body[r])]; }
    Range nodes(std::size_t r) const { return body_nodes[static_cast<std::size_t>(body[r])]; }
    bool asleep(std::size_t r) const {
        return !body_asleep.empty() && body_asleep[static_cast<std::size_t>(body[r])] != 0;
    }
    /// Damping rate of the material of a body [1/s].
    Real damping(std::size_t r) const {
        return material_damping[static_cast<std::size_t>(body_material[static_cast<std::size_t>(body[r])])];
    }
    /// Rotation from the frame of the mesh to the world.
    Mat3 turn(std::size_t r) const { return rotation[r] * axes[r].transpose(); }
};

/// Long step of the implicit bodies with small strain, during which other bodies take several short steps.
struct LongStepTimes {
    Real length = 0;      // length of a long step; 0 if all bodies take the same step [s]
    bool starts = false;  // true if the long step starts with this short step
    bool ends = false;    // true if the long step ends with this short step
};

/// Step lengths, and the factor theta (1/2 to 1). The elastic force in a step is theta times the force at the end of
/// the step plus 1 - theta times the force at its start.
struct ImplicitTimes : LongStepTimes {
    Real h = 0;  // [s]
    Real theta = 1;

    static ImplicitTimes bind(const Binder& binder, const Real& h, const Real& theta, const LongStepTimes& long_step) {
        ImplicitTimes times{binder.value(long_step)};
        times.h = binder.value(h);
        times.theta = binder.value(theta);
        return times;
    }
};

struct ImplicitLoads {
    std::span<const Vec3> load;  // applied force by node; empty if there are no applied forces [N]
    Vec3 gravity;                // accelerates only nodes of held bodies: the frames of free bodies fall [m/s^2]
    // Time for which loads act on explicit and rigid bodies: the force interval of docs/methods/time_stepping.md 1.5.
    // On implicit bodies loads act for the complete step [s].
    Real kick;

    static ImplicitLoads bind(const Binder& binder, const NodeTable& node, const Vec3& gravity, const bool& forced,
                              const Real& kick) {
        return {.load = binder.read_if(binder.value(forced), node.applied_force),
                .gravity = binder.value(gravity),
                .kick = binder.value(kick)};
    }
};

/// Columns of RigidBodyTable: rotational state of the frames; used only for free bodies.
struct ImplicitSpins {
    std::span<const Vec3> moments, angular_momentum, moment_kick, contact_moment, push_spin;

    static ImplicitSpins bind(const Binder& binder, const RigidBodyTable& rigid) {
        return {.moments = binder.read(rigid.moments),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .moment_kick = binder.read(rigid.moment_kick),
                .contact_moment = binder.read(rigid.contact_moment),
                .push_spin = binder.read(rigid.push_spin)};
    }

    /// Angular momentum in the world frame at the end of the step: kicked() without the contacts of the step, after()
    /// with these contacts [kg m^2/s].
    Vec3 kicked(std::size_t r) const { return angular_momentum[r] + moment_kick[r]; }
    Vec3 after(std::size_t r) const { return angular_momentum[r] + (moment_kick[r] + contact_moment[r]); }
};

struct ImplicitKicks {
    std::span<Vec3> elastic_force, impulse, velocity_next, contact_impulse;  // ImplicitNodeTable
    std::span<Vec3> node_velocity_next;                                      // by node [m/s]

    static ImplicitKicks bind(const Binder& binder, ImplicitNodeTable& implicit, NodeTable& node) {
        return {.elastic_force = binder.write(implicit.elastic_force),
                .impulse = binder.write(implicit.impulse),
                .velocity_next = binder.write(implicit.velocity_next),
                .contact_impulse = binder.write(implicit.contact_impulse),
                .node_velocity_next = binder.write(node.velocity_next)};
    }
};

/// Computes out.velocity_next, the velocities with which the node displacements change in the step, in the frame of the
/// mesh (docs/methods/implicit_bodies.md 2). At large strain they are the result of Newton's method. Adds them to the
/// node velocities that kick_rigid_bodies has computed from the motion of the frames. Computes missing matrix factors
/// for the step length.
///
/// For a held body out.velocity_next is the velocity in the world, rotated into the frame at the start of the step. The
/// velocities of its held nodes are already set.
///
/// Parallel over bodies. Returns false if there is no implicit body (skipped).
bool kick_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const ImplicitLoads& loads,
                          const ImplicitSpins& spins, const ImplicitTimes& times, StiffBodies& stiff,
                          const ImplicitKicks& out);

/// Stencils (nodes and weights) of the points at which the region solver applies impulses: contacts and cable points.
struct TouchedNodes {
    std::span<const Stencil> contact, cable_point;

    static TouchedNodes bind(const Binder& binder, const ContactTable& contact, const CableBlockTable& cable) {
        return {binder.read(contact.stencil), binder.read(cable.stencil)};
    }
};

/// Lists the nodes of implicit bodies that contacts and cables touch. For each body, computes the velocities of its
/// touched nodes per unit impulse on each of them. Returns false if no contact or cable touches an implicit body
/// (skipped).
bool couple_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const TouchedNodes& stencils,
                            std::span<const Index> node_body, const ImplicitTimes& times, StiffBodies& stiff,
                            ImplicitCoupling& coupling);

struct ImplicitStrains {
    std::span<const Vec3> elastic_force, contact_impulse;                   // ImplicitNodeTable
    std::span<Vec3> impulse, force_rate, velocity_next, displacement_next;  // ImplicitNodeTable
    // RigidBodyTable:
    std::span<Vec3> hold_moment, moments_next;
    std::span<Mat3> axes_next, rotation_shaped;
    std::span<std::uint8_t> large_next;
    std::span<Vec3> force;  // force by node, written only for held nodes [N]

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

/// Result of strain_implicit_bodies for one body.
struct StrainPart {
    Real damped = 0;  // damped energy minus the work of the moment of the attachment [J]
    // Impulse of weight and loads over the complete step of length h, minus their impulse over the time loads.kick
    // [N s]. Only this difference is returned, because the balance of momentum counts the impulse over loads.kick
    // elsewhere.
    Vec3 impulse = Vec3::Zero();
};

struct StrainFindings {
    // Sums of StrainPart::damped and StrainPart::impulse over all bodies:
    Real damped = 0;
    Vec3 impulse = Vec3::Zero();
    NewtonCounts newton;
    Index unsolved = no_index;  // first row of BodyTable for which Newton's method failed
};

/// Computes velocities and displacements at the end of the step. Returns sums over all bodies except ghosts, which are
/// counted by the ranks that own them. Parallel over bodies.
/// - `force`: receives the elastic forces at held nodes; the sum is rescaled to forces that act for the time
///   loads.kick.
/// - `hold_moment`: receives the angular impulses by which attachments balance the elastic forces of held bodies
///   [N m s].
/// - `parts`: work memory by row of RigidBodyTable.
StrainFindings strain_implicit_bodies(Executor& executor, const ImplicitBodies& bodies, const ImplicitLoads& loads,
                                      const ImplicitSpins& spins, const ImplicitTimes& times, StiffBodies& stiff,
                                      const ImplicitStrains& out, Column<StrainPart>& parts);

/// Advances the long step of every body by the short step that is being committed. When a long step ends,
/// ImplicitNodeTable::left receives the displacements that its contacts cause in a complete long step, because the next
/// long step first assumes the same effect. It receives 0 for bodies that took an ordinary step.
void carry_long_steps(const ImplicitTimes& times, std::span<const Index> body, std::span<const Range> body_implicit,
                      StiffBodies& stiff, std::span<Vec3> left);

/// Writes to `out` the displacements that result from the present velocities in the time `seconds`, and all other
/// columns that turn_rigid_bodies reads (ElasticMotion).
void drift_implicit_bodies(const ImplicitBodies& bodies, const ImplicitSpins& spins, StiffBodies& stiff, Real seconds,
                           const ImplicitStrains& out);

}  // namespace skerry
