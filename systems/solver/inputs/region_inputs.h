// Inputs and outputs of the stage solve_regions, as spans of table columns.
#pragma once

#include <span>

#include "components/contact_table.h"
#include "components/implicit_coupling.h"
#include "components/implicit_node_table.h"
#include "components/joint_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "components/surface_rules.h"
#include "components/types.h"
#include "jobs/access.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// State of the rigid bodies at the start of the step, and the kick (change of momentum by the forces of the step) [N
/// s]. Spans have one entry per row of RigidBodyTable, except `position` and `core_nodes`.
struct RigidInputs {
    RigidNodes nodes{};
    std::span<const Vec3> position{};  // by node [m]
    std::span<const Vec3> center{};
    std::span<const Real> mass{};
    RigidSpins spins{};
    std::span<const Vec3> momentum{}, kick{};
    std::span<const Vec3> moments{};
    std::span<const Mat3> rotation{};
    std::span<const Index> body{}, core_nodes{};  // `body`: row of BodyTable; `core_nodes`: by row of BodyTable
    // Row of AttachmentTable of the attachment that prescribes the motion of the body (the body is held), or no_index.
    // The span is empty if no body is held.
    //
    // An implicit body is held by the frame relative to which it deforms. The frame's row of RigidBodyTable then has
    // zero velocity, and the nodes store their total velocity (docs/methods/implicit_bodies.md 7).
    std::span<const Index> holder{};

    bool any() const { return nodes.any(); }
    /// Inverse mass of a body; 0 if the body is held [1/kg]
    Real inverse_mass(std::size_t r) const { return holder.empty() || holder[r] == no_index ? 1 / mass[r] : 0; }
    Vec3 velocity(std::size_t r) const { return (momentum[r] + kick[r]) / mass[r]; }
    bool is_capsule(Index r) const { return core_of(r) == 2; }
    bool is_cylinder(Index r) const { return core_of(r) == cylinder_core_nodes; }
    /// Rounding radius of a round body [m]
    Real radius(Index r) const {
        return nodes.round_radius[static_cast<std::size_t>(body[static_cast<std::size_t>(r)])];
    }

    /// Number of core nodes of the body at row `r` of RigidBodyTable; 0 if the body is not round. Core nodes define the
    /// centre or axis of a round body.
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

/// State of the implicit bodies: deformation velocities relative to moving frames. The frames are rows of
/// RigidBodyTable.
struct ImplicitInputs {
    std::span<const Range> body_implicit{};      // by row of BodyTable: rows of ImplicitNodeTable
    const ImplicitCoupling* coupling = nullptr;  // null or empty if no contact touches an implicit body
    // Velocity after the kick (the change of velocity by forces), and velocity at the start of the step, in the mesh
    // frame, by row of ImplicitNodeTable [m/s]
    std::span<const Vec3> velocity{}, velocity_before{};
    std::span<const Mat3> axes{}, rotation{};  // by RigidBodyTable row; rotation axes^T: from mesh frame to world frame

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
    /// Returns the node's row of ImplicitNodeTable, or no_index if its body is not implicit.
    Index row(Index node, const RigidNodes& nodes) const {
        if (!any()) return no_index;
        const auto body = static_cast<std::size_t>(nodes.node_body[static_cast<std::size_t>(node)]);
        const Range rows = body_implicit[body];
        return rows.size() == 0 ? no_index : rows.begin + node - nodes.body_nodes[body].begin;
    }
    /// Velocity of a node relative to the rigid motion of its frame, in world axes. `row` is a row of
    /// ImplicitNodeTable, `body` a row of RigidBodyTable [m/s]
    Vec3 deforming(Index row, Index body) const {
        const auto r = static_cast<std::size_t>(body);
        return rotation[r] * (axes[r].transpose() * velocity[static_cast<std::size_t>(row)]);
    }
    /// Change of a node's velocity by the forces of this step, relative to the frame of its implicit body, in world
    /// axes [m/s]. It is zero for nodes of other bodies. Elastic forces cause most of it. In a body at rest, contact
    /// impulses cancel it in every step.
    Vec3 deformation_kick(Index node, const RigidNodes& nodes) const {
        const Index row = this->row(node, nodes);
        if (row == no_index) return Vec3::Zero();
        const auto r = static_cast<std::size_t>(nodes.row(node)), at = static_cast<std::size_t>(row);
        return rotation[r] * (axes[r].transpose() * (velocity[at] - velocity_before[at]));
    }
};

/// Inputs of solve_regions: contacts, nodes, bodies, joints and cables.
struct RegionInputs {
    std::span<const Stencil> stencil;
    std::span<const Vec3> normal;
    std::span<const Real> gap;
    std::span<const Vec3> surface_velocity;
    std::span<const Real> static_friction, dynamic_friction, restitution;
    std::span<const Real> inverse_mass;  // by node [1/kg]
    std::span<const Vec3> velocity;      // by node, at the start of the step [m/s]
    Real gravity = 0;                    // magnitude of gravity, for the scale of the error measure [m/s^2]
    // Ascending contact keys. They identify regions across steps, so that the scheduler can predict the cost of a
    // region from its sweep counts in earlier steps. The span may be empty.
    std::span<const ContactKey> key{};
    // Clusters: groups of nodes with a coupled mass matrix. Null or empty if every node has its own mass.
    const NodeClusters* clusters = nullptr;
    std::span<const Vec3> cluster_kick{};  // impulse of this step's forces, by item of clusters->nodes [N s]
    RigidInputs rigid{};                   // no rigid bodies by default
    ImplicitInputs implicit{};             // deformations of the implicit bodies; none by default
    std::span<const JointBlock> joints{};  // joints between rigid bodies; none by default
    SolvedCables cables{};                 // none by default
    // first_body and second_body: rows of BodyTable of the two bodies of a contact, or no_index. body_kind and
    // still_time: by row of BodyTable; they tell which bodies are still (SolverSettings::still_tolerance). If the spans
    // are empty, no body counts as still.
    std::span<const Index> first_body{}, second_body{};
    std::span<const BodyKind> body_kind{};
    std::span<const Real> still_time{};  // [s]
    TouchPoints touch{};                 // contact points on cylinders, and points of ties
    // friction axis of each contact; empty: friction is the same in all directions
    std::span<const FrictionAxis> friction_axis{};

    /// True if the contact at this row is a tie, which is a bilateral constraint: its impulse may also pull (see
    /// FrictionLimits). TouchPoints::point then holds the point at which the impulse acts on both bodies.
    bool is_tie(Index row) const { return dynamic_friction[static_cast<std::size_t>(row)] == infinity; }
    bool clustered() const { return clusters != nullptr && !clusters->empty(); }

    /// The column `velocity` holds the node velocities at the start of the step.
    static RegionInputs bind(const Binder& binder, const ContactTable& contact, const NodeTable& node,
                             const Column<Vec3>& velocity, const Real& gravity, const NodeClusters& clusters,
                             const Column<Vec3>& cluster_kick, const BodyTable& body, const RigidBodyTable& rigid,
                             const ImplicitNodeTable& implicit, const ImplicitCoupling& coupling,
                             const JointBlockTable& joints, const CableBlockTable& cables,
                             const SurfaceSetTable& sets) {
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
                .cables = SolvedCables::bind(binder, cables),
                .first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .body_kind = binder.read(body.kind),
                .still_time = binder.read(body.still_time),
                .touch = TouchPoints::bind(binder, contact),
                .friction_axis = binder.read_if(binder.read(sets).any_direction(), contact.friction_axis)};
    }
};

struct RegionOutputs {
    std::span<Vec3> impulse;        // by contact: before the solve the warm start, after it the solution [N s]
    std::span<Vec3> velocity_next;  // by node: before the solve the predicted velocity, after it the solution [m/s]
    std::span<Vec3> push_out;       // by node, except of rigid bodies: pseudo velocity of the split impulse [m/s]
    // Contact impulses, moments and pseudo velocities by row of RigidBodyTable. They must be zero before the solve.
    std::span<Vec3> contact_impulse{}, contact_moment{}, push_velocity{}, push_spin{};
    std::span<Vec3> deforming_impulse{};     // by row of ImplicitNodeTable, zero before the solve [N s]
    std::span<Vec3> joint_impulse{};         // by joint block: warm start as input, solution as output
    std::span<AxisImpulses> axis_impulse{};  // by joint block
    std::span<Real> cable_impulse{};         // by cable point, impulse of the tension: warm start, then solution [N s]
    std::span<Real> cable_work{};            // by solved cable: work on the bodies [J]
    std::span<Real> cable_loss{};            // by solved cable: energy that friction at its points dissipates [J]
    std::span<Vec3> cable_sum{};             // by solved cable: total impulse on the moving nodes [N s]

    static RegionOutputs bind(const Binder& binder, ContactTable& contact, NodeTable& node, RigidBodyTable& rigid,
                              ImplicitNodeTable& implicit, JointBlockTable& joints, CableBlockTable& cables) {
        const auto first = static_cast<std::size_t>(binder.read(cables.first_solved));
        const std::span<Real> work = binder.write(cables.work), loss = binder.write(cables.dissipated);
        const std::span<Vec3> sum = binder.write(cables.sum_impulse);
        return {.impulse = binder.write(contact.impulse),
                .velocity_next = binder.write(node.velocity_next),
                .push_out = binder.write(node.push_out),
                .contact_impulse = binder.write(rigid.contact_impulse),
                .contact_moment = binder.write(rigid.contact_moment),
                .push_velocity = binder.write(rigid.push_velocity),
                .push_spin = binder.write(rigid.push_spin),
                .deforming_impulse = binder.write(implicit.contact_impulse),
                .joint_impulse = binder.write(joints.impulse),
                .axis_impulse = binder.write(joints.axis_impulse),
                .cable_impulse = binder.write(cables.impulse),
                .cable_work = work.subspan(std::min(first, work.size())),
                .cable_loss = loss.subspan(std::min(first, loss.size())),
                .cable_sum = sum.subspan(std::min(first, sum.size()))};
    }
};

}  // namespace skerry
