// Sums element forces at the nodes and adds weight and loads.
#pragma once

#include <span>

#include "components/element_table.h"
#include "components/ragged.h"
#include "components/step_levels.h"
#include "jobs/executor.h"

namespace skerry {

/// Which element forces count in this step. With empty spans all do.
struct DueCorners {
    std::span<const Index> block_begin = {}, block_end = {}, block_body = {};  // NodeBlockTable
    std::span<const LevelMask> body_due = {};                                  // BodyTable
    std::span<const LevelMask> node_levels = {};                               // NodeTable
    std::span<const std::uint8_t> level = {};                                  // ElementBlockTable
    std::span<const std::uint8_t> body_asleep = {};                            // BodyTable; nodes at rest keep what they had
};

/// force = sum of the element forces of the corners around the node that are due, in a fixed order, + mass gravity + load. `corners` lists
/// for each node 4 * element + corner. Parallel over node blocks, or
/// over nodes where none are given.
void gather_node_forces(Executor& executor, RaggedView<Index> corners, const DueCorners& due, std::span<const ElementForces> element_force,
                        std::span<const Real> mass, const Vec3& gravity, std::span<const Vec3> load, std::span<Vec3> force);

}  // namespace skerry
