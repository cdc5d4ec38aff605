// Displacement of each body in its moving frame, and its travel, which is the sum of the changes of displacement. Both
// values limit how long results of the collision stages remain valid.
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct DisplacementInputs {
    std::span<const Real> block_displacement_squared;  // NodeBlockTable; at the present positions [m^2]
    std::span<const Range> body_node_blocks;           // BodyTable
    std::span<const Index> block_begin, block_end;     // NodeBlockTable
    std::span<const Real> body_mean_edge;              // [m]
    std::span<const Vec3> position;                    // present positions [m]
    std::span<const Vec3> velocity;                    // present velocities [m/s]

    static DisplacementInputs bind(const Binder& binder, const NodeBlockTable& block, const BodyTable& body,
                                   const NodeTable& node) {
        return {.block_displacement_squared = binder.read(block.displacement_squared),
                .body_node_blocks = binder.read(body.node_blocks),
                .block_begin = binder.read(block.begin),
                .block_end = binder.read(block.end),
                .body_mean_edge = binder.read(body.mean_edge),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity)};
    }

    /// Nodes of a body that count for its displacement: all nodes, or for a round body only the nodes in node blocks.
    Range nodes(std::size_t body) const {
        const Range blocks = body_node_blocks[body];
        if (blocks.size() == 0) return {0, 0};
        return {block_begin[static_cast<std::size_t>(blocks.begin)],
                block_end[static_cast<std::size_t>(blocks.end - 1)]};
    }
};

struct DisplacementOutputs {
    std::span<Vec3> origin;  // by node: position when the displacement of its body was last reset to zero [m]
    // Flag of each body, or empty. 1: set the displacement of the body to zero and clear the flag.
    std::span<std::uint8_t> rebase;
    std::span<MovingFrame> frame;  // BodyTable
    std::span<Real> frame_speed, displacement, travel;

    static DisplacementOutputs bind(const Binder& binder, NodeTable& node, Column<std::uint8_t>& rebase,
                                    BodyTable& body) {
        return {.origin = binder.write(node.displacement_origin),
                .rebase = binder.write(rebase),
                .frame = binder.write(body.frame),
                .frame_speed = binder.write(body.frame_speed),
                .displacement = binder.write(body.displacement),
                .travel = binder.write(body.travel)};
    }
};

/// Greatest squared distance of the nodes of a block from their displacement origins, after the origins have moved by
/// `offset` [m^2]. advance_positions stores the result for each block.
Real block_displacement_squared(std::span<const Vec3> position, std::span<const Vec3> origin, const Vec3& offset);

/// Updates displacement and travel of each body (docs/methods/collision.md 2.1) after positions have moved for the time
/// `seconds` [s]. Parallel over bodies.
/// - Displacement: greatest distance of a node from its origin. Origins move with the frame of the body.
/// - Travel: grows by the change of displacement, so neither vibration nor flight adds to it in the long run. Since an
///   earlier time t no node has moved further, relative to the frame, than travel - travel(t) + 2 displacement(t).
///
/// If the displacement exceeds a small fraction of the mean edge, or on request, it is reset to zero: the origins move
/// to the nodes, and the frame gets the mean velocity of the nodes. Travel is unchanged, and frame_speed becomes the
/// greatest speed of the nodes relative to the frame [m/s].
void measure_displacement(Executor& executor, const DisplacementInputs& bodies, Real seconds,
                          const DisplacementOutputs& out);

}  // namespace skerry
