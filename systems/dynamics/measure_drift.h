// How far each body has come, for the budgets of the collision stages.
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/node_block_table.h"
#include "jobs/executor.h"

namespace skerry {

struct DriftInputs {
    std::span<const Real> block_drift_squared;  // m^2, NodeBlockTable; of the positions now
    std::span<const Range> body_node_blocks;    // BodyTable
    std::span<const Range> body_nodes;
    std::span<const Real> body_mean_edge;  // m
    std::span<const Vec3> position;        // m, now
};

struct DriftOutputs {
    std::span<Vec3> origin;          // m, by node: where it was when its body's drift was last zero
    std::span<std::uint8_t> rebase;  // by body, or empty: 1 asks for a drift of zero; cleared
    std::span<Real> drift, travel;   // BodyTable
};

/// Greatest squared distance of the nodes of a block from their origins, m^2. advance_positions writes it by block.
Real block_drift_squared(std::span<const Vec3> position, std::span<const Vec3> origin);

/// drift = greatest distance of a node from its origin; travel grows by the change of drift, so that a body that only trembles does not travel. When the
/// drift exceeds a small part of the mean edge, or on request, the origins move to where the nodes are: drift is zero again, travel stays.
/// No node is ever further from where it was at an earlier time than travel - (travel then) + 2 (drift then). Parallel over
/// bodies.
void measure_drift(Executor& executor, const DriftInputs& bodies, const DriftOutputs& out);

}  // namespace skerry
