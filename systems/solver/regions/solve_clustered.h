// Regions whose contacts touch clusters of nodes (docs/methods/clusters.md 4).
#pragma once

#include "systems/solver/operators/through_clusters.h"
#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// Notes which clusters the contacts of each region touch, and where its nodes are kept: those of its clusters have
/// rows whether contacts name them or not. Returns how many rows of nodes all regions need.
std::size_t find_region_clusters(const RegionInputs& inputs, const RegionTable& regions, RegionMemory& memory);

inline bool touches_cluster(const RegionMemory& memory, Index number) {
    return memory.region_clusters.size() > 0 && !memory.region_clusters[static_cast<std::size_t>(number)].empty();
}

/// Solves one such region, by one thread.
RegionOutcome solve_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base);

}  // namespace skerry
