// Solver of regions whose contacts touch clusters of nodes but no rigid body (docs/methods/clusters.md 4).
#pragma once

#include "systems/solver/operators/through_clusters.h"
#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// Solves one such region in one thread.
RegionOutcome solve_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base);

}  // namespace skerry
