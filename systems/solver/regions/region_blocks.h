// Lists of the node clusters and rigid bodies that the contacts of each region touch.
#pragma once

#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// Fills the lists and the place of the first node of each region. All nodes of a touched cluster get rows, and a rigid
/// body gets two. Returns the number of node rows that all regions need.
std::size_t find_region_blocks(const RegionInputs& inputs, const RegionTable& regions, RegionMemory& memory);

inline bool touches_cluster(const RegionMemory& memory, Index number) {
    return memory.region_clusters.size() > 0 && !memory.region_clusters[static_cast<std::size_t>(number)].empty();
}
inline bool touches_rigid(const RegionMemory& memory, Index number) {
    return memory.region_rigid.size() > 0 && !memory.region_rigid[static_cast<std::size_t>(number)].empty();
}

/// Number of places by node for a region that touches clusters or rigid bodies.
std::size_t room_of_region(const RegionInputs& inputs, const RegionMemory& memory, std::size_t contacts, Index number);

}  // namespace skerry
