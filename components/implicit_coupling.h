// What contacts on bodies that move implicitly do to each other in this step, through what these deform
// (docs/methods/implicit_bodies.md 4).
#pragma once

#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

using PaddedMat3 = Eigen::Matrix<Real, 4, 3>;  // the fourth row is zero

/// Made by couple_implicit_bodies.
struct ImplicitCoupling {
    Ragged<Index> nodes;              // by row of RigidBodyTable: rows of NodeTable that contacts touch, ascending
    Column<std::size_t> first_block;  // by row of RigidBodyTable
    Column<PaddedMat3> block;         // 1/kg, world: row by row for each body, by places among its touched nodes
    Column<Index> place;              // by row of ImplicitNodeTable: among the touched nodes of the body, or no_index

    /// By what an impulse on one touched node moves all of them.
    std::span<const PaddedMat3> row(std::size_t body, Index at) const {
        const std::size_t count = nodes[body].size();
        return block.span().subspan(first_block[body] + static_cast<std::size_t>(at) * count, count);
    }
};

}  // namespace skerry
