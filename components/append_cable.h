// Appends rows to CableBlockTable.
#pragma once

#include "components/cable_table.h"

namespace skerry {

/// Appends one row to each column with one row per point. `stencil` and `velocity` get the arguments
/// (CableBlockTable::velocity [m/s]). The other columns get values without effect, which the caller may overwrite: 1
/// for most_ratio, which means no friction; else 0.
inline void append_point(const Stencil& stencil, const Vec3& velocity, CableBlockTable& blocks) {
    blocks.stencil.push_back(stencil);
    blocks.velocity.push_back(velocity);
    blocks.direction.push_back(Vec3::Zero());
    blocks.length.push_back(0);
    blocks.most_ratio.push_back(1);
    blocks.impulse.push_back(0);
}

/// Removes all points from row `count` on. No block may contain these points.
inline void truncate_points(Index count, CableBlockTable& blocks) {
    const auto rows = static_cast<std::size_t>(count);
    blocks.stencil.resize(rows);
    blocks.velocity.resize(rows);
    blocks.direction.resize(rows);
    blocks.length.resize(rows);
    blocks.most_ratio.resize(rows);
    blocks.impulse.resize(rows);
}

/// Appends a block. Its points must already be in the table. For a solved block, `mobilities` grows by the number of
/// entries of its mobility matrix, which has a row and a column per impulse.
inline void append_block(const CableBlock& block, CableBlockTable& blocks) {
    if (block.solved) blocks.mobilities += block.impulses() * block.impulses();
    blocks.block.push_back(block);
    blocks.work.push_back(0);
    blocks.dissipated.push_back(0);
    blocks.sum_impulse.push_back(Vec3::Zero());
}

}  // namespace skerry
