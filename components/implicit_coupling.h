// Coupling between the contacts of an implicit body: an impulse at one contact deforms the body and so changes the
// velocity at the other contacts (docs/methods/implicit_bodies.md 4).
#pragma once

#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// Written by couple_implicit_bodies.
struct ImplicitCoupling {
    Ragged<Index> nodes;  // by row of RigidBodyTable: the nodes with contacts, as ascending rows of NodeTable
    // Symmetric matrix that maps impulses on the nodes with contacts to velocities of these nodes, in the frame of the
    // mesh [1/kg]; one for each row of RigidBodyTable. It is stored column by column, with three rows per node. The
    // implicit bodies own the memory.
    Column<std::span<const Real>> response;
    // Matrices, one for each row of RigidBodyTable.
    // - `turn` rotates velocities from the frame of the mesh to the world frame.
    // - `impulse_turn` rotates impulses from the world frame to the frame of the mesh, and multiplies them by the
    //   parameter theta of the time integration. In a long step, which covers several steps of the world, it also
    //   contains the factor t/h (docs/methods/implicit_bodies.md 9). h is the length of the present step of the world,
    //   t the time from the start of the long step to the end of the present step.
    Column<Mat3> turn, impulse_turn;
    Column<Index> touched_index;  // by row of ImplicitNodeTable: index of the node in `nodes` of its body, or no_index

    std::size_t numbers(std::size_t body) const { return 3 * nodes[body].size(); }
    /// The three columns of `response` for an impulse on node number `at` of `nodes`, one column after the other.
    std::span<const Real> columns(std::size_t body, Index at) const {
        return response[body].subspan(3 * static_cast<std::size_t>(at) * numbers(body), 3 * numbers(body));
    }
    /// Velocity of node number `to` of `nodes` per unit impulse on node number `from`, in the frame of the mesh [1/kg].
    Mat3 block_in_frame(std::size_t body, Index to, Index from) const {
        const std::span<const Real> column_numbers = columns(body, from);
        Mat3 block;
        for (Index c = 0; c < 3; ++c)
            for (Index r = 0; r < 3; ++r)
                block(r, c) =
                    column_numbers[static_cast<std::size_t>(c) * numbers(body) + static_cast<std::size_t>(3 * to + r)];
        return block;
    }
    Mat3 to_world(std::size_t body, const Mat3& in_frame) const { return turn[body] * in_frame * impulse_turn[body]; }
    Mat3 block(std::size_t body, Index to, Index from) const { return to_world(body, block_in_frame(body, to, from)); }
};

}  // namespace skerry
