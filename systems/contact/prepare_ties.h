// Prepares the equations of the ties in this step (docs/methods/ties.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/cable_table.h"
#include "components/collider_table.h"
#include "components/contact_table.h"
#include "components/node_table.h"
#include "components/options.h"
#include "components/rigid_body_table.h"
#include "components/tie_table.h"
#include "jobs/access.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// Point of the other object to which a node is tied, at the start of the step.
struct TieTarget {
    Vec3 point;   // [m]
    Vec3 normal;  // unit normal of the surface
    // Weights of the corners of the triangle, if the other object is a deformable body.
    Vec3 weight = Vec3::Zero();
};

/// Calls visit(node, share) for each node of a list. `nodes`: the list, numbered as in the mesh of the body. `first`:
/// row of NodeTable of the first node of the body. `node`: row of NodeTable. `share`: mass of the node divided by the
/// mass of all nodes of the list.
void for_each_share(std::span<const Index> nodes, Index first, std::span<const Real> mass, auto&& visit) {
    Real sum = 0;
    for (const Index node : nodes) sum += mass[static_cast<std::size_t>(first + node)];
    for (const Index node : nodes) visit(first + node, mass[static_cast<std::size_t>(first + node)] / sum);
}

struct TieInputs {
    const TieTable& tie;
    std::span<const Range> body_nodes, body_rigid, body_implicit;  // BodyTable
    std::span<const std::uint8_t> body_asleep;                     // column of BodyTable; empty if no body is asleep
    // Columns of NodeTable. `velocity_next`: predicted velocity [m/s]
    std::span<const Vec3> position, velocity_next;
    std::span<const Real> node_mass, inverse_mass;  // [kg], [1/kg]
    // RigidBodyTable
    std::span<const Vec3> center, rest_center;
    std::span<const Mat3> axes, rotation;
    std::span<const Real> mass;
    std::span<const Vec3> momentum, kick;
    std::span<const Index> holder;
    RigidSpins spins;
    std::span<const RigidMotion> motion;  // by collider

    static TieInputs bind(const Binder& binder, const TieTable& tie, const BodyTable& body, const NodeTable& node,
                          const RigidBodyTable& rigid, const ColliderTable& collider, const bool& any_asleep) {
        return {.tie = binder.read(tie),
                .body_nodes = binder.read(body.nodes),
                .body_rigid = binder.read(body.rigid),
                .body_implicit = binder.read(body.implicit),
                .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep),
                .position = binder.read(node.position),
                .velocity_next = binder.read(node.velocity_next),
                .node_mass = binder.read(node.mass),
                .inverse_mass = binder.read(node.inverse_mass),
                .center = binder.read(rigid.center),
                .rest_center = binder.read(rigid.rest_center),
                .axes = binder.read(rigid.axes),
                .rotation = binder.read(rigid.rotation),
                .mass = binder.read(rigid.mass),
                .momentum = binder.read(rigid.momentum),
                .kick = binder.read(rigid.kick),
                .holder = binder.read(rigid.holder),
                .spins = RigidSpins::bind(binder, rigid),
                .motion = binder.read(collider.motion)};
    }

    /// Row of RigidBodyTable of a rigid or implicit body; no_index for explicit bodies and for no body.
    Index frame(Index body) const {
        if (body == no_index) return no_index;
        const Range rows = body_rigid[static_cast<std::size_t>(body)];
        return rows.size() > 0 ? rows.begin : no_index;
    }
    bool deforms(Index body) const {
        return body != no_index &&
               (frame(body) == no_index || body_implicit[static_cast<std::size_t>(body)].size() > 0);
    }
    /// Row of NodeTable of a node that is numbered as in the mesh of its body.
    Index row_of(Index body, Index node) const { return body_nodes[static_cast<std::size_t>(body)].begin + node; }
    std::span<const Index> nodes_of(std::size_t t) const { return rows_of(tie.node.span(), tie.nodes[t]); }
    /// True if the tie is not broken, and is fixed to a collider that moves in this step.
    bool is_led(std::size_t t) const {
        const Index collider = tie.collider[t];
        return collider != no_index && !motion[static_cast<std::size_t>(collider)].stands_still() && tie.holds(t);
    }
    /// True if no object of tie `t` can move in this step, because its bodies are asleep.
    bool rests(std::size_t t) const;
    /// Calls visit(node, share) for each node of tie `t`. `node`: row of NodeTable. `share`: mass of the node divided
    /// by the mass of all nodes of the tie.
    void for_each_share(std::size_t t, auto&& visit) const {
        skerry::for_each_share(nodes_of(t), row_of(tie.first[t], 0), node_mass, visit);
    }
    /// Mean point of the nodes of a tie, weighted by their masses [m].
    Vec3 mean_point(std::size_t t) const {
        Vec3 mean = Vec3::Zero();
        for_each_share(t, [&](Index node, Real share) { mean += share * position[static_cast<std::size_t>(node)]; });
        return mean;
    }
    /// Point of the other object to which a node is tied, at the start of the step. `t`: row of the tie. `k`: row of
    /// the node in the columns of TieTable that have one entry per tied node. A tie of the kind `ball` ties only the
    /// mean point of its nodes; `k` is then the row of its first node.
    TieTarget target(std::size_t t, std::size_t k) const;
};

/// Frame of a triangle: the first axis along its first edge, the third along its normal.
Mat3 triangle_axes(const std::array<Vec3, 3>& corner);

/// Times and solver settings of a step. `h`: step length [s]. `kick`: time for which forces act [s].
struct TieStep {
    Real h = 0, kick = 0;
    // upper limit of the speed at which the position errors of bodies without spin are corrected [m/s]
    Real recovery_speed = 0;
    WarmStart warm_start = WarmStart::on;
};

/// Prepares the ties that neither rest nor are broken: appends a row to the contacts for each unbroken node of a weld
/// or slide, and a block to `blocks` for each tie of the kind `ball`. Returns false if there is no tie (skipped).
///
/// The equations require a position error of zero at the end of the step. Larger errors decrease at a limited speed:
/// recovery_speed plus the speeds of the tied points due to the spins of their bodies.
bool prepare_ties(const TieInputs& ties, const TieStep& step, ContactTable& contacts, TieRowTable& rows,
                  CableBlockTable& blocks);

/// Sets `marked` to 1 for each body that is tied to a moving collider. Returns false if there is no such body.
bool mark_led(const TieInputs& ties, std::span<std::uint8_t> marked);

}  // namespace skerry
