// Nodes that forces move.
#pragma once

#include <span>

#include "components/range.h"
#include "components/types.h"

namespace skerry {

/// Shows which nodes forces can move: those that are neither held nor part of a held body.
struct FreeNodes {
    std::span<const Real> inverse_mass;  // by node; 0 for a held node [1/kg]
    std::span<const Index> node_body;    // by node: row of BodyTable
    std::span<const Range> body_rigid;   // column BodyTable::rigid
    std::span<const Index> holder;       // column RigidBodyTable::holder

    /// Tables: NodeTable, BodyTable, RigidBodyTable.
    static FreeNodes bind(const auto& binder, const auto& node, const auto& body, const auto& rigid) {
        return {.inverse_mass = binder.read(node.inverse_mass),
                .node_body = binder.read(node.body),
                .body_rigid = binder.read(body.rigid),
                .holder = binder.read(rigid.holder)};
    }

    bool contain(std::size_t n) const {
        const Range rigid = body_rigid[static_cast<std::size_t>(node_body[n])];
        return inverse_mass[n] > 0 && (rigid.size() == 0 || holder[static_cast<std::size_t>(rigid.begin)] == no_index);
    }
};

}  // namespace skerry
