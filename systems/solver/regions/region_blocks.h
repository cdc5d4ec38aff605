// Which clusters of nodes and rigid bodies the contacts of each region touch.
#pragma once

#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// Notes them, and where the nodes of each region are kept: those of its clusters have rows whether contacts name them
/// or not, and a rigid body has two. Returns how many rows of nodes all regions need.
std::size_t find_region_blocks(const RegionInputs& inputs, const RegionTable& regions, RegionMemory& memory);

inline bool touches_cluster(const RegionMemory& memory, Index number) {
    return memory.region_clusters.size() > 0 && !memory.region_clusters[static_cast<std::size_t>(number)].empty();
}
inline bool touches_rigid(const RegionMemory& memory, Index number) {
    return memory.region_rigid.size() > 0 && !memory.region_rigid[static_cast<std::size_t>(number)].empty();
}

/// Places in the memory by node of a region that touches some of them.
std::size_t room_of_region(const RegionInputs& inputs, const RegionMemory& memory, std::size_t contacts, Index number);

}  // namespace skerry
