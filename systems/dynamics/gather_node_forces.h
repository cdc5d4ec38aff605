// Sums element forces at the nodes and adds weight and loads.
#pragma once

#include <span>

#include "components/element_table.h"
#include "components/ragged.h"
#include "jobs/executor.h"

namespace skerry {

/// force = sum of the element forces of the corners around the node, in a fixed order, + mass gravity + load. `corners` lists for each
/// node 4 * element + corner. Parallel over nodes.
void gather_node_forces(Executor& executor, RaggedView<Index> corners, std::span<const ElementForces> element_force,
                        std::span<const Real> mass, const Vec3& gravity, std::span<const Vec3> load, std::span<Vec3> force);

}  // namespace skerry
