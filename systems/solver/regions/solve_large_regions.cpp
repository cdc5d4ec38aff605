#include "systems/solver/regions/solve_large_regions.h"

#include "systems/solver/regions/region_blocks.h"

namespace skerry {

RegionByColour load_by_colour(const RegionStage& stage, std::span<const Index> row, Index base, Team& team,
                              ColouredRegion& kept) {
    RegionByColour region =
        lumped_region(stage, row, base, 4 * static_cast<std::size_t>(base), kept.node.span(), kept.traversal(team));
    region.traversal.nodes(kept.node.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) region.memory.velocity[n] = free_velocity_of(stage, kept.node[n]);
    });
    load_lumped_contacts(stage, region, [&](std::size_t number) {
        // load_contact calls the returned function once for each moving node of the contact, in the order in which
        // kept.local lists these nodes. So the function needs no search for the node.
        return [next = kept.local[number].data()](Index) mutable { return *next++; };
    });
    return region;
}

bool is_large(const RegionStage& stage, const RegionTable& regions, Index number) {
    const std::size_t contacts = regions.contacts[static_cast<std::size_t>(number)].size();
    return !stage.settings.fixed_iterations &&
           contacts >= static_cast<std::size_t>(stage.settings.parallel_region_contacts) &&
           !touches_cluster(stage.memory, number) && !needs_blocks(stage.memory, regions, number);
}

void solve_large_regions(Executor& executor, const RegionStage& stage, RegionTable& regions) {
    LargeRegions& large = stage.memory.large;
    std::size_t count = 0;
    for (std::size_t r = 0; r < regions.size(); ++r) count += is_large(stage, regions, static_cast<Index>(r)) ? 1 : 0;
    if (count == 0) return;
    while (large.region.size() < count) large.region.push_back(std::make_unique<ColouredRegion>());
    large.team.gather(executor, [&] {
        std::size_t next = 0;
        for (std::size_t r = 0; r < regions.size(); ++r) {
            if (!is_large(stage, regions, static_cast<Index>(r))) continue;
            ColouredRegion& kept = *large.region[next++];
            order_region(stage.inputs, regions.contacts[r], large.team, stage.memory.node_index.span(), kept);
            const RegionByColour region =
                load_by_colour(stage, regions.contacts[r], regions.contacts.offset[r], large.team, kept);
            write_outcome(solve_loaded(stage, region), static_cast<Index>(r), regions);
        }
    });
}

}  // namespace skerry
