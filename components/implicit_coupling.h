// Coupling of contacts on implicit bodies in this step through the deformation of these bodies
// (docs/methods/implicit_bodies.md 4).
#pragma once

#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// Written by couple_implicit_bodies.
struct ImplicitCoupling {
    Ragged<Index> nodes;  // by row of RigidBodyTable: rows of NodeTable that contacts touch, ascending
    // The columns of the bodies have one row per row of RigidBodyTable. `response`: velocities of the touched nodes per
    // unit impulse on them, in the frame of the mesh [1/kg]: a symmetric matrix, column by column, three numbers per
    // node. The bodies own the memory.
    Column<std::span<const Real>> response;
    Column<Mat3> turn, impulse_turn;  // velocities from the frame of the mesh to the world; impulses back, times theta
    Column<Index> place;  // by row of ImplicitNodeTable: index among the touched nodes of the body, or no_index

    std::size_t numbers(std::size_t body) const { return 3 * nodes[body].size(); }
    /// Three columns of `response`, one after the other.
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
