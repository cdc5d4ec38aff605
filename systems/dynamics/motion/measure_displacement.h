// How far each body has come, for the budgets of the collision stages.
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
    std::span<const Real> block_displacement_squared;  // m^2, NodeBlockTable; of the positions now
    std::span<const Range> body_node_blocks;           // BodyTable
    std::span<const Index> block_begin, block_end;     // NodeBlockTable
    std::span<const Real> body_mean_edge;              // m
    std::span<const Vec3> position;                    // m, now
    std::span<const Vec3> velocity;                    // m/s, now

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

    /// In blocks: all, or of a round body some.
    Range nodes(std::size_t body) const {
        const Range blocks = body_node_blocks[body];
        if (blocks.size() == 0) return {0, 0};
        return {block_begin[static_cast<std::size_t>(blocks.begin)],
                block_end[static_cast<std::size_t>(blocks.end - 1)]};
    }
};

struct DisplacementOutputs {
    std::span<Vec3> origin;          // m, by node: where it was when its body's displacement was last zero
    std::span<std::uint8_t> rebase;  // by body, or empty: 1 asks for a displacement of zero; cleared
    std::span<MovingFrame> frame;    // BodyTable
    std::span<Real> frame_speed, displacement, travel;

    /// `rebase`: by body.
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

/// Greatest squared distance of the nodes of a block from their origins, which have moved on by `offset` (m), m^2.
/// advance_positions writes it by block.
Real block_displacement_squared(std::span<const Vec3> position, std::span<const Vec3> origin, const Vec3& offset);

/// After positions have moved on by `seconds`: frames move on as long, displacement = greatest distance of a node from
/// its origin, which goes with the frame; travel grows by the change of displacement, so that a body that only trembles
/// does not travel, nor one that flies. When the displacement exceeds a small part of the mean edge, or on request, the
/// origins move to where the nodes are and the frame takes their mean velocity: displacement is zero again, travel
/// stays; frame_speed (m/s) becomes that of the nodes in the new frame. In its frame no node is ever further from where
/// it was at an earlier time than travel - (travel then) + 2 (displacement then). Parallel over bodies.
void measure_displacement(Executor& executor, const DisplacementInputs& bodies, Real seconds,
                          const DisplacementOutputs& out);

}  // namespace skerry
