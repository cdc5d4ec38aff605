#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/world/complaint.h"
#include "engine/world/ranks/hold/ghosts.h"
#include "engine/world/ranks/rows/body_rows.h"
#include "engine/world/step/step.h"
#include "jobs/arithmetic_scope.h"
#include "skerry/ranks.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_division(const char* field, const char* found, const char* expected, const char* hint) {
    Complaint{.file = {}, .object = "distribute", .field = field, .found = found, .expected = expected, .hint = hint}
        .raise();
}

/// Refuses worlds that ranks cannot divide.
void require_divisible(const WorldState& world) {
    const Settings& settings = world.model.settings;
    if (world.ranks.on())
        refuse_division("world", "a world that is already divided", "an undivided world", "call it once");
    if (settings.integrator == Integrator::leapfrog)
        refuse_division("settings.integrator", "leapfrog", "symplectic_euler",
                        "several ranks have only this integrator");
    if (settings.contact_regions == ContactRegions::global)
        refuse_division("settings.contact_regions", "global", "separate", "ranks solve regions concurrently");
    if (world.record.forces.on())
        refuse_division("measure_forces", "forces that are measured", "none", "measure forces with one process");
    if (world.record.problem_watch.take)
        refuse_division("watch_problems", "a subscription to contact problems", "none",
                        "export problems with one process");
}

/// Orders the entries as the undivided world does: by the check that found the crossing first, then by row.
void sort_self_crossings(WorldState& world) {
    std::ranges::stable_sort(world.record.self_crossings, {}, [&](const SelfCrossing& found) {
        return std::pair(found.first_time, world.model.body_map.row(found.body));
    });
}

}  // namespace

void distribute(World& world, Ranks& ranks, const RankSettings& settings) {
    WorldState& state = WorldAccess::state_of(world);
    state.require_between_steps("distribute");
    require_divisible(state);
    if (ranks.size() == 1) return;
    const ArithmeticScope arithmetic;  // as in advance(), which would otherwise choose the clusters
    world.settle_start();
    state.settle();
    Model& model = state.model;
    note_changed_seams(model);
    settle_clusters(model, state.scratch.stiffness_sum);
    RankState& mine = state.ranks;
    mine.ranks = &ranks;
    mine.rank = ranks.rank();
    mine.whole = whole_world_of(model);
    mine.whole.settings = settings;
    mine.whole.searched_step = state.record.counters.steps;
    mine.place.resize(model.bodies.slot.size());
    std::iota(mine.place.begin(), mine.place.end(), Index{0});
    std::vector<std::uint8_t> moves;
    for (const BodyKind kind : model.bodies.kind) moves.push_back(kind == BodyKind::deformable);
    const std::vector<BodyExtent> extents = extents_of(state, moves);
    WholeWorld& whole = mine.whole;
    whole.owner = choose_owners(whole, extents, settings, ranks.size());
    whole.holders = find_holders(whole, whole.owner, extents, ranks.size());
    std::vector<std::uint8_t> kept;
    for (std::size_t b = 0; b < moves.size(); ++b)
        kept.push_back(!moves[b] || std::ranges::binary_search(whole.holders[b], mine.rank));
    replace_rows(state, kept, {}, [&](std::uint64_t pair) { return whole.pair_owner(pair, whole.owner) == mine.rank; });
    note_holders(mine, extents);
    note_ghosts(state);
    list_step_again(state);
}

std::optional<World> gathered(const World& world) {
    WorldState& state = WorldAccess::state_of(const_cast<World&>(world));  // rows are read, not changed
    if (!state.ranks.on()) return world.clone();
    const RankState& mine = state.ranks;
    std::vector<std::uint8_t> owned;
    for (const Index place : mine.place) owned.push_back(mine.whole.owner[place] == mine.rank);
    BodyRows rows = rows_of_bodies(
        state, owned, [&](std::uint64_t pair) { return mine.whole.pair_owner(pair, mine.whole.owner) == mine.rank; });
    const std::vector<RankMessage> all = mine.ranks->gather(mine.rank == 0 ? RankMessage() : message_of(rows));
    if (mine.rank != 0) return std::nullopt;
    World whole = copy_of_settled(state, {});
    WorldState& copy = WorldAccess::state_of(whole);
    copy.ranks.place = mine.place;
    copy.ranks.whole = mine.whole;
    std::vector<BodyRows> added;
    for (std::size_t rank = 1; rank < all.size(); ++rank) added.push_back(rows_of_message(all[rank]));
    std::vector<std::uint8_t> kept;
    for (const Index place : mine.place) {
        const std::int32_t owner = mine.whole.owner[place];
        kept.push_back(owner == mine.rank || owner == WholeWorld::everywhere);
    }
    replace_rows(copy, kept, added, [](std::uint64_t) { return true; });
    sort_self_crossings(copy);
    copy.ranks = {};
    note_ghosts(copy);
    copy.model.of_ranks = {};
    return whole;
}

}  // namespace skerry
