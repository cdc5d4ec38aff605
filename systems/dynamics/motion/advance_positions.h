// Drift of the nodes: moves the positions by the velocities and makes the new state the present one.
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "components/types.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct AdvanceInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    std::span<const std::uint8_t> body_asleep = {};             // column of BodyTable; empty if no body is asleep
    std::span<const Vec3> velocity_next;                        // [m/s]
    std::span<const Vec3> displacement_origin;                  // node positions at the last reset of displacement [m]
    std::span<const MovingFrame> body_frame = {};               // column of BodyTable; empty if all frames are at rest

    /// `velocity`: column of the velocities with which nodes move. `any_asleep`: true if some body is asleep.
    static AdvanceInputs bind(const Binder& binder, const NodeBlockTable& block, const BodyTable& body,
                              const NodeTable& node, const Column<Vec3>& velocity, const bool& any_asleep) {
        return {.block_begin = binder.read(block.begin),
                .block_end = binder.read(block.end),
                .block_body = binder.read(block.body),
                .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep),
                .velocity_next = binder.read(velocity),
                .displacement_origin = binder.read(node.displacement_origin),
                .body_frame = binder.read(body.frame)};
    }
};

struct AdvanceOutputs {
    std::span<Vec3> push_out;  // empty if no contact pushes nodes out of an overlap [m/s]
    std::span<Vec3> position;
    std::span<Vec3> velocity;
    std::span<Real> block_displacement_squared;  // [m^2]

    /// `pushed`: true if some contact pushes nodes out of an overlap.
    static AdvanceOutputs bind(const Binder& binder, NodeTable& node, NodeBlockTable& block, const bool& pushed) {
        return {.push_out = binder.write_if(binder.read(pushed), node.push_out),
                .position = binder.write(node.position),
                .velocity = binder.write(node.velocity),
                .block_displacement_squared = binder.write(block.displacement_squared)};
    }
};

/// Sets position += h (velocity_next + push_out), velocity = velocity_next and push_out = 0, except for nodes of
/// sleeping bodies. Also computes, for measure_displacement, the greatest squared distance of the nodes of each block
/// from their displacement origins. These origins move with the frame of the body. Parallel over node blocks.
void advance_positions(Executor& executor, const AdvanceInputs& nodes, Real h, const AdvanceOutputs& out);

}  // namespace skerry
