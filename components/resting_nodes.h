// Nodes of bodies that are asleep. Steps do not change these nodes.
#pragma once

#include <cstdint>
#include <span>

#include "components/types.h"

namespace skerry {

/// Shows which nodes belong to sleeping bodies. If the spans are empty, no body is asleep.
struct RestingNodes {
    std::span<const Index> node_body = {};           // column of NodeTable: row of BodyTable
    std::span<const std::uint8_t> body_asleep = {};  // column BodyTable::asleep

    bool contain(std::size_t node) const {
        return !body_asleep.empty() && body_asleep[static_cast<std::size_t>(node_body[node])] != 0;
    }
};

}  // namespace skerry
