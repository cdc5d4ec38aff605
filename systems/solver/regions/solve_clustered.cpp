#include "systems/solver/operators/through_clusters.h"
#include "systems/solver/regions/region_blocks.h"
#include "systems/solver/regions/solve_region.h"

namespace skerry {

RegionOutcome solve_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base) {
    const NodeClusters& clusters = *stage.inputs.clusters;
    const auto r = static_cast<std::size_t>(number);
    const std::size_t first_node = stage.memory.node_base[r];
    NodeList list(stage.memory, first_node, room_of_region(stage.inputs, stage.memory, row.size(), number));
    LumpedRegion<ThroughClusters> region =
        lumped_region(stage, row, base, first_node, list.node(), ThroughClusters(clusters, list.node()));
    // ThroughClusters expects the nodes of each cluster in consecutive rows of the region, also nodes without contacts.
    // So all nodes of the touched clusters are listed before the contacts add theirs.
    for (const Index c : stage.memory.region_clusters[r])
        for (const Index node : clusters.nodes[static_cast<std::size_t>(c)])
            list.index_of(node, [&] { return free_velocity_of(stage, node); });
    load_listed(stage, list, region);
    return solve_loaded(stage, region);
}

}  // namespace skerry
