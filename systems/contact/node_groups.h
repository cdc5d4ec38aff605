// Which nodes do not move by themselves: those of a rigid body, and those of a cluster.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <span>

#include "components/body_table.h"
#include "components/contact_table.h"
#include "components/joint_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"

namespace skerry {

struct RigidNodes {
    std::span<const Index> node_body;      // NodeTable
    std::span<const Range> body_nodes;     // BodyTable
    std::span<const Range> body_rigid;     // BodyTable; empty: no body is rigid
    std::span<const Real> round_radius{};  // BodyTable; empty: no body is round

    static RigidNodes bind(const Binder& binder, const NodeTable& node, const BodyTable& body,
                           const RigidBodyTable& rigid) {
        const bool any = !binder.read(rigid.mass).empty();
        return {.node_body = binder.read(node.body),
                .body_nodes = binder.read(body.nodes),
                .body_rigid = binder.read_if(any, body.rigid),
                .round_radius = binder.read_if(any, body.round_radius)};
    }

    bool any() const { return !body_rigid.empty(); }
    /// Row of the rigid body that a node moves with, or no_index.
    Index row(Index node) const {
        if (!any()) return no_index;
        const Range rows = body_rigid[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])];
        return rows.size() > 0 ? rows.begin : no_index;
    }
    /// m, of the round body in whose core a node is; 0: it is a point.
    Real radius(Index node) const {
        return round_radius.empty() ? 0
                                    : round_radius[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])];
    }
    /// m/s: by how much the surfaces of the round bodies in a contact pass each other by their spins, where they touch.
    /// The place of a core has nodes of the stencil whose weights have the sum 1 or -1, and it is touched at -radius
    /// normal from there, or at +radius normal. `spin(r)`: rad/s, by row of RigidBodyTable.
    Vec3 rolling(const Stencil& stencil, const Vec3& normal, auto&& spin) const {
        Vec3 sum = Vec3::Zero();
        if (round_radius.empty()) return sum;
        for (std::size_t a = 0; a < 4; ++a)
            if (const Real r = radius(stencil.node[a]); r > 0 && stencil.weight[a] != 0)
                sum -= std::abs(stencil.weight[a]) * r *
                       spin(static_cast<std::size_t>(row(stencil.node[a]))).cross(normal);
        return sum;
    }
    /// The first node of the rigid body that a node belongs to, or itself.
    Index leader(Index node) const {
        return row(node) == no_index
                   ? node
                   : body_nodes[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])].begin;
    }
};

/// How rigid bodies spin, by row of RigidBodyTable.
struct RigidSpins {
    std::span<const Mat3> inverse_inertia{};  // 1/(kg m^2), world
    std::span<const Vec3> angular_momentum{}, moment_kick{};

    static RigidSpins bind(const Binder& binder, const RigidBodyTable& rigid) {
        return {.inverse_inertia = binder.read(rigid.inverse_inertia),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .moment_kick = binder.read(rigid.moment_kick)};
    }

    /// rad/s, at the start of the step.
    Vec3 before(std::size_t r) const { return inverse_inertia[r] * angular_momentum[r]; }
    /// rad/s, with the moment of forces.
    Vec3 kicked(std::size_t r) const { return inverse_inertia[r] * (angular_momentum[r] + moment_kick[r]); }
};

/// All of them, and what joints join; no node is of both kinds.
struct NodeGroups {
    const NodeClusters* clusters = nullptr;  // null: none
    RigidNodes rigid{};
    std::span<const JointBlock> joints{};

    static NodeGroups bind(const Binder& binder, const NodeClusters& clusters, const NodeTable& node,
                           const BodyTable& body, const RigidBodyTable& rigid, const JointBlockTable& joints) {
        // but the matrices, which may still change in a step
        binder.value(clusters.nodes);
        binder.value(clusters.body);
        binder.value(clusters.cluster_of);
        return {.clusters = &clusters,
                .rigid = RigidNodes::bind(binder, node, body, rigid),
                .joints = binder.read(joints.block)};
    }

    bool empty() const { return (clusters == nullptr || clusters->empty()) && !rigid.any() && joints.empty(); }
    /// The first node of the group that a node belongs to, or itself.
    Index leader(Index node) const { return rigid.leader(clusters == nullptr ? node : clusters->leader(node)); }
};

}  // namespace skerry
