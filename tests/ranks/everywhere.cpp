#include "tests/ranks/everywhere.h"

#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "components/union_find.h"
#include "engine/world/step/step.h"
#include "engine/world/world_state.h"

namespace skerry::test {

void hold_everywhere(World& world, Ranks& ranks) {
    WorldState& state = WorldAccess::state_of(world);
    world.settle_start();  // as distribute() does
    state.settle();
    note_changed_seams(state.model);
    settle_clusters(state.model, state.scratch.stiffness_sum);
    RankState& rank_state = state.ranks;
    rank_state.ranks = &ranks;
    rank_state.rank = ranks.rank();
    for (int rank = 0; rank < ranks.size(); ++rank)
        if (rank != ranks.rank()) rank_state.peers.push_back(rank);
    const BodyTable& bodies = state.model.bodies;
    std::vector<int> all(rank_state.peers.size());
    std::iota(all.begin(), all.end(), 0);
    UnionFind units;
    units.start(bodies.slot.size());
    for (std::size_t link = 0; link < state.model.links.first.size(); ++link)
        units.join(state.model.links.first[link], state.model.links.second[link]);
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) {
        const bool moves = bodies.kind[b] == BodyKind::deformable;
        const auto unit = static_cast<std::size_t>(units.root(static_cast<Index>(b)));
        rank_state.owner.push_back(moves ? static_cast<int>(bodies.slot[unit]) % ranks.size() : ranks.rank());
        rank_state.holders.push_back(moves ? all : std::vector<int>{});
        rank_state.world_row.push_back(static_cast<Index>(b));
    }
    // no rank needs to search for other bodies
    rank_state.margin.assign(bodies.slot.size(), infinity);
    rank_state.moved.assign(bodies.slot.size(), 0);
    rank_state.tried_speed.assign(bodies.slot.size(), 0);
    rank_state.whole.searched_step = std::numeric_limits<std::uint64_t>::max() / 2;
    note_ghosts(state);
    list_step_again(state);
}

}  // namespace skerry::test
