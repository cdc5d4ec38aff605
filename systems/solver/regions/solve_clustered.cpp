#include "systems/solver/regions/solve_clustered.h"

#include "systems/solver/methods/run_method.h"
#include "systems/solver/regions/load_nodes.h"

namespace skerry {
namespace {

using ClusteredRegion = LoadedRegion<ThroughClusters>;

/// As load_region; first come the nodes of the clusters, then those that contacts name beside them.
ClusteredRegion load_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base) {
    RegionMemory& data = stage.memory;
    const NodeClusters& clusters = *stage.inputs.clusters;
    const auto first = static_cast<std::size_t>(data.node_base[number]);
    std::size_t room = 4 * row.size();
    for (const Index c : data.region_clusters[static_cast<std::size_t>(number)])
        room += clusters.nodes[static_cast<std::size_t>(c)].size();
    const std::span<Index> node = data.node.span().subspan(first, room);
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

std::size_t find_region_clusters(const RegionInputs& inputs, const RegionTable& regions, RegionMemory& memory) {
    // first the places of regions without clusters, four by contact, then those of regions with clusters
    std::size_t end = 4 * regions.contacts.item.size();
    memory.region_clusters.clear();
    if (!inputs.clustered()) return end;
    const NodeClusters& clusters = *inputs.clusters;
    memory.region_clusters.offset.push_back(0);
    memory.node_base.resize(regions.size());
    memory.region_of_cluster.assign(clusters.size(), no_index);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        memory.node_base[r] = end;
        for (const Index contact : regions.contacts[r]) {
            const Stencil& stencil = inputs.stencil[static_cast<std::size_t>(contact)];
            for (std::size_t a = 0; a < 4; ++a) {
                if (stencil.weight[a] == 0) continue;
                const Index c = clusters.cluster(stencil.node[a]);
                if (c == no_index || memory.region_of_cluster[c] == static_cast<Index>(r)) continue;
                memory.region_of_cluster[c] = static_cast<Index>(r);
                memory.region_clusters.item.push_back(c);
                end += clusters.nodes[static_cast<std::size_t>(c)].size();
            }
        }
        if (end > memory.node_base[r]) end += 4 * regions.contacts[r].size();
        memory.region_clusters.offset.push_back(static_cast<Index>(memory.region_clusters.item.size()));
    }
    return end;
}

RegionOutcome solve_clustered(const RegionStage& stage, std::span<const Index> row, Index number, Index base) {
    const ClusteredRegion region = load_clustered(stage, row, number, base);
    RegionOutcome outcome;
    if (!start_region(stage, region, outcome)) {
        LumpedOperatorBy<ThroughClusters> op = operator_of(stage, region);
        outcome = outcome_of(run_method(stage.settings.method, op, limits_of(stage.settings)));
    }
    finish_region(stage, region, outcome);
    return outcome;
}

}  // namespace skerry
