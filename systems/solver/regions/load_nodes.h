// Loading of a region that one thread solves: its contacts and the list of its nodes.
#pragma once

#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// Lists nodes in the order of their first appearance and loads the contacts. `list_first(local)` can list nodes before
/// the contacts do. `node` and the velocities of the region must have room for all nodes. `place` caches a node's place
/// in the list, by row of NodeTable. Regions share no moving node, so they do not overwrite each other's entries. A
/// stale entry is detected because the list holds a different node at that place.
template <RegionWalk Walk, class ListFirst>
void load_nodes_and_contacts(const RegionStage& stage, std::span<Index> node, LoadedRegion<Walk>& region,
                             ListFirst&& list_first) {
    RegionMemory& data = stage.memory;
    const std::span<Vec4> velocity = region.memory.velocity;
    std::size_t node_count = 0;
    const auto local = [&](Index global) {
        Index& place = data.place[global];
        if (static_cast<std::size_t>(place) < node_count && node[place] == global) return place;
        place = static_cast<Index>(node_count);
        node[node_count] = global;
        velocity[node_count++] = padded(stage.out.velocity_next[global]);
        return place;
    };
    list_first(local);
    load_contacts(
        stage, region, [&](std::size_t) -> const auto& { return local; });
    region.memory.node = node.first(node_count);
    region.memory.velocity = velocity.first(node_count);
    region.memory.scratch = region.memory.scratch.first(node_count);
}

}  // namespace skerry
