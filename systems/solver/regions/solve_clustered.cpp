#include "systems/solver/regions/solve_clustered.h"

#include "systems/solver/methods/run_method.h"
#include "systems/solver/regions/load_nodes.h"
#include "systems/solver/regions/region_blocks.h"

namespace skerry {
namespace {

using ClusteredRegion = LoadedRegion<ThroughClusters>;

/// Variant of load_region: nodes of the clusters come first, then the other nodes of the contacts.
ClusteredRegion load_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base) {
    RegionMemory& data = stage.memory;
    const NodeClusters& clusters = *stage.inputs.clusters;
    const auto first = static_cast<std::size_t>(data.node_base[number]);
    const std::span<Index> node =
        data.node.span().subspan(first, room_of_region(stage.inputs, data, row.size(), number));
    ClusteredRegion region{.row = row,
                           .base = base,
                           .walk = ThroughClusters(clusters, node),
                           .memory = memory_from(stage, base, row.size(), node, first)};
    load_nodes_and_contacts(stage, node, region, [&](const auto& local) {
        for (const Index c : data.region_clusters[static_cast<std::size_t>(number)])
            for (const Index n : clusters.nodes[static_cast<std::size_t>(c)]) local(n);
    });
    return region;
}

}  // namespace

RegionOutcome solve_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base) {
    const ClusteredRegion region = load_clustered(stage, row, number, base);
    RegionOutcome outcome;
    if (!start_region(stage, region, outcome)) {
        LumpedOperatorBy<ThroughClusters> op = operator_of(stage, region);
        const SolveLimits limits = limits_of(stage.settings, region.tolerance);
        outcome = outcome_of(run_method(stage.settings.method, op, limits), stage.settings);
    }
    finish_region(stage, region, outcome);
    return outcome;
}

}  // namespace skerry
