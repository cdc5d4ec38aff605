// Nodes that forces move.
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"

namespace skerry {

/// Tells whether forces move a node: the node is neither held nor part of a held body.
struct FreeNodes {
    std::span<const Real> inverse_mass;  // by node; 0 for a held node [1/kg]
    std::span<const Index> node_body;    // by node
    std::span<const Range> body_rigid;   // BodyTable
    std::span<const Index> holder;       // RigidBodyTable

    static FreeNodes bind(const Binder& binder, const NodeTable& nodes, const BodyTable& bodies,
                          const RigidBodyTable& rigid) {
        return {.inverse_mass = binder.read(nodes.inverse_mass),
                .node_body = binder.read(nodes.body),
                .body_rigid = binder.read(bodies.rigid),
                .holder = binder.read(rigid.holder)};
    }

    bool contain(std::size_t n) const {
        const Range rigid = body_rigid[static_cast<std::size_t>(node_body[n])];
        return inverse_mass[n] > 0 && (rigid.size() == 0 || holder[static_cast<std::size_t>(rigid.begin)] == no_index);
    }
};

}  // namespace skerry
