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
    RankState& mine = state.ranks;
    mine.ranks = &ranks;
    mine.rank = ranks.rank();
    for (int rank = 0; rank < ranks.size(); ++rank)
        if (rank != ranks.rank()) mine.peers.push_back(rank);
    const BodyTable& bodies = state.model.bodies;
    std::vector<int> all(mine.peers.size());
    std::iota(all.begin(), all.end(), 0);
    UnionFind units;
    units.start(bodies.slot.size());
    for (std::size_t link = 0; link < state.model.links.first.size(); ++link)
        units.join(state.model.links.first[link], state.model.links.second[link]);
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) {
        const bool moves = bodies.kind[b] == BodyKind::deformable;
        const auto unit = static_cast<std::size_t>(units.root(static_cast<Index>(b)));
        mine.owner.push_back(moves ? static_cast<int>(bodies.slot[unit]) % ranks.size() : ranks.rank());
        mine.holders.push_back(moves ? all : std::vector<int>{});
        mine.place.push_back(static_cast<Index>(b));
    }
    // no rank needs to search for other bodies
    mine.margin.assign(bodies.slot.size(), infinity);
    mine.moved.assign(bodies.slot.size(), 0);
    mine.tried_speed.assign(bodies.slot.size(), 0);
    mine.whole.searched_step = std::numeric_limits<std::uint64_t>::max() / 2;
    note_ghosts(state);
    list_step_again(state);
}

}  // namespace skerry::test
