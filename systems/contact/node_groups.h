// Which nodes do not move by themselves: those of a rigid body, and those of a cluster.
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/joint_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"

namespace skerry {

struct RigidNodes {
    std::span<const Index> node_body;   // NodeTable
    std::span<const Range> body_nodes;  // BodyTable
    std::span<const Range> body_rigid;  // BodyTable; empty: no body is rigid

    static RigidNodes bind(const Binder& binder, const NodeTable& node, const BodyTable& body,
                           const RigidBodyTable& rigid) {
        const bool any = !binder.read(rigid.mass).empty();
        return {.node_body = binder.read(node.body),
                .body_nodes = binder.read(body.nodes),
                .body_rigid = binder.read_if(any, body.rigid)};
    }

    bool any() const { return !body_rigid.empty(); }
    /// Row of the rigid body that a node moves with, or no_index.
    Index row(Index node) const {
        if (!any()) return no_index;
        const Range rows = body_rigid[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])];
        return rows.size() > 0 ? rows.begin : no_index;
    }
    /// The first node of the rigid body that a node belongs to, or itself.
    Index leader(Index node) const {
        return row(node) == no_index
                   ? node
                   : body_nodes[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])].begin;
    }
};

/// All of them, and what joints join; no node is of both kinds.
struct NodeGroups {
    const NodeClusters* clusters = nullptr;  // null: none
    RigidNodes rigid{};
    std::span<const JointBlock> joints{};

    static NodeGroups bind(const Binder& binder, const NodeClusters& clusters, const NodeTable& node,
                           const BodyTable& body, const RigidBodyTable& rigid, const JointBlockTable& joints) {
        return {.clusters = &binder.value(clusters),
                .rigid = RigidNodes::bind(binder, node, body, rigid),
                .joints = binder.read(joints.block)};
    }

    bool empty() const { return (clusters == nullptr || clusters->empty()) && !rigid.any() && joints.empty(); }
    /// The first node of the group that a node belongs to, or itself.
    Index leader(Index node) const { return rigid.leader(clusters == nullptr ? node : clusters->leader(node)); }
};

}  // namespace skerry
