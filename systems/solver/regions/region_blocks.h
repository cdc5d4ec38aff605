// Lists of the node clusters and rigid bodies that each region touches.
#pragma once

#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// Lists the clusters and rigid bodies of each region (those that its contacts, joints and cables touch), and finds its
/// first node row. All nodes of a touched cluster get rows, and a rigid body gets two rows. Returns the number of node
/// rows of all regions.
std::size_t find_region_blocks(const RegionInputs& inputs, const RegionTable& regions, RegionMemory& memory);

inline bool touches_cluster(const RegionMemory& memory, Index number) {
    return memory.region_clusters.size() > 0 && !memory.region_clusters[static_cast<std::size_t>(number)].empty();
}
inline bool touches_rigid(const RegionMemory& memory, Index number) {
    return memory.region_rigid.size() > 0 && !memory.region_rigid[static_cast<std::size_t>(number)].empty();
}
/// True if a region needs the operator with 3x3 blocks (BodyOperator): it touches rigid or implicit bodies, it has a
/// cable, or the friction of a contact depends on the direction.
inline bool needs_blocks(const RegionMemory& memory, const RegionTable& regions, Index number) {
    return touches_rigid(memory, number) || !regions.cables_of(static_cast<std::size_t>(number)).empty() ||
           (!memory.region_has_axes.empty() && memory.region_has_axes[static_cast<std::size_t>(number)] != 0);
}

/// Total number of points of the given solved cables.
std::size_t points_of_cables(const RegionInputs& inputs, std::span<const Index> cables);

/// Upper bound of the number of node rows of a region that touches clusters or rigid bodies, or that has cables.
/// `stencils`: number of its contacts and points of cables.
std::size_t room_of_region(const RegionInputs& inputs, const RegionMemory& memory, std::size_t stencils, Index number);

}  // namespace skerry
