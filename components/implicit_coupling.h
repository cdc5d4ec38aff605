// Coupling between the contacts of an implicit body through the deformation of the body
// (docs/methods/implicit_bodies.md 4).
#pragma once

#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// Written by couple_implicit_bodies.
struct ImplicitCoupling {
    Ragged<Index> nodes;  // by row of RigidBodyTable: the nodes that contacts touch, as ascending rows of NodeTable
    // Velocities of the touched nodes per unit impulse on them, in the frame of the mesh [1/kg], by row of
    // RigidBodyTable. This is a symmetric matrix, stored column by column, with three numbers per node. The implicit
    // bodies own the memory.
    Column<std::span<const Real>> response;
    // Rotations by row of RigidBodyTable. `turn` maps velocities from the frame of the mesh to the world.
    // `impulse_turn` maps impulses from the world to the frame of the mesh, and scales them by theta and the weight of
    // a long step.
    Column<Mat3> turn, impulse_turn;
    Column<Index> place;  // by row of ImplicitNodeTable: index among the touched nodes of the body, or no_index

    std::size_t numbers(std::size_t body) const { return 3 * nodes[body].size(); }
    /// The three columns of `response` for the touched node `at`, one after the other.
    std::span<const Real> columns(std::size_t body, Index at) const {
        return response[body].subspan(3 * static_cast<std::size_t>(at) * numbers(body), 3 * numbers(body));
    }
    /// Velocity response of the touched node `to` to an impulse on the touched node `from`, in the frame of the mesh
    /// [1/kg].
    Mat3 block_in_frame(std::size_t body, Index to, Index from) const {
        const std::span<const Real> of = columns(body, from);
        Mat3 block;
        for (Index c = 0; c < 3; ++c)
            for (Index r = 0; r < 3; ++r)
                block(r, c) = of[static_cast<std::size_t>(c) * numbers(body) + static_cast<std::size_t>(3 * to + r)];
        return block;
    }
    Mat3 to_world(std::size_t body, const Mat3& in_frame) const { return turn[body] * in_frame * impulse_turn[body]; }
    Mat3 block(std::size_t body, Index to, Index from) const { return to_world(body, block_in_frame(body, to, from)); }
};

}  // namespace skerry
