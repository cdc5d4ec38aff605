#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/ranks/act_together.h"
#include "engine/world/ranks/hold/ghosts.h"
#include "engine/world/ranks/rows/body_rows.h"
#include "engine/world/ranks/rows/put_record.h"
#include "engine/world/step/step.h"
#include "jobs/arithmetic_scope.h"
#include "skerry/ranks.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_division(const char* field, const char* found, const char* expected, const char* hint) {
    refuse("distribute", field, found, expected, hint);
}

/// Throws SceneError for worlds that cannot be divided among ranks.
void require_divisible(const WorldState& world) {
    const Settings& settings = world.model.settings;
    if (settings.integrator == Integrator::leapfrog)
        refuse_division("settings.integrator", "leapfrog", "symplectic_euler",
                        "several ranks support only this integrator");
    if (settings.contact_regions == ContactRegions::global)
        refuse_division("settings.contact_regions", "global", "separate", "ranks solve regions concurrently");
    if (world.record.forces.on())
        refuse_division("measure_forces", "forces that are measured", "none", "measure forces with one process");
    if (world.record.problem_watch.take)
        refuse_division("watch_problems", "a subscription to contact problems", "none",
                        "export problems with one process");
}

/// Sorts the self-crossings as in the undivided world: by the time of the check that first found the crossing, then by
/// row of the body.
void sort_self_crossings(WorldState& world) {
    std::ranges::stable_sort(world.record.self_crossings, {}, [&](const SelfCrossing& found) {
        return std::pair(found.first_time, world.model.body_map.row(found.body));
    });
}

/// Collective: all ranks must call it. Returns the message of rank 0. `own_message`: message of this rank, used only on
/// rank 0.
RankMessage message_of_first(Ranks& ranks, std::span<const std::byte> own_message) {
    return std::move(ranks.gather_everywhere(own_message).front());
}

/// Number of messages (batches) in which a rank sends its bodies to another rank. With several messages, only a part of
/// the bodies is in memory twice at a time, as table rows and as a message.
constexpr Index batches = 8;

/// Message with the table rows of those marked bodies that belong to one batch. The first message also contains the
/// contact data of the pairs that the rank `pairs_of` searches (WholeWorld::pair_owner). `with_records`: true if the
/// message contains the BodyRecord of each body.
RankMessage message_of_batch(WorldState& world, std::span<const std::uint8_t> marked, Index batch, int pairs_of,
                             bool with_records) {
    const WholeWorld& whole = world.ranks.whole;
    std::vector<std::uint8_t> sent;
    for (std::size_t b = 0; b < marked.size(); ++b)
        sent.push_back(marked[b] != 0 && whole.unit[world.ranks.world_row[b]] % batches == batch);
    BodyRows rows = rows_of_bodies(
        world, sent, [&](std::uint64_t pair) { return batch == 0 && whole.pair_owner(pair, whole.owner) == pairs_of; });
    if (with_records) copy_records(world.model, sent, rows);
    return message_of(rows);
}

/// Calls visit(member) for all facts about the undivided world that rank 0 sends to the others.
void for_each_fact(WholeWorld& whole, std::vector<BodyExtent>& extents, Model& model, auto&& visit) {
    visit(whole.owner);
    visit(whole.slot);
    visit(whole.unit);
    visit(whole.world_row_of_slot);
    visit(extents);
    visit(model.forced);
    visit(model.disabled_pairs.key);
}

void join_ranks(RankState& rank_state, Ranks& ranks, const RankSettings& settings, std::uint64_t step) {
    rank_state.ranks = &ranks;
    rank_state.rank = ranks.rank();
    rank_state.whole.settings = settings;
    rank_state.whole.searched_step = step;
}

/// Completes all pending changes of a world, as before a step, and chooses the owners of its bodies.
std::vector<BodyExtent> choose_parts(World& world, Ranks& ranks, const RankSettings& settings) {
    WorldState& state = WorldAccess::state_of(world);
    require_divisible(state);
    world.settle_start();
    state.settle();
    Model& model = state.model;
    note_changed_seams(model);
    settle_clusters(model, state.scratch.stiffness_sum);
    RankState& rank_state = state.ranks;
    rank_state.whole = whole_world_of(model);
    join_ranks(rank_state, ranks, settings, state.record.counters.steps);
    rank_state.world_row.resize(model.bodies.slot.size());
    std::iota(rank_state.world_row.begin(), rank_state.world_row.end(), Index{0});
    std::vector<std::uint8_t> moves;
    for (const BodyKind kind : model.bodies.kind) moves.push_back(kind == BodyKind::deformable);
    std::vector<BodyExtent> extents = extents_of(state, moves);
    rank_state.whole.owner = choose_owners(rank_state.whole, extents, settings, ranks.size());
    rank_state.whole.holders = find_holding_ranks(rank_state.whole, rank_state.whole.owner, extents, ranks.size());
    return extents;
}

/// Returns the bytes of the part of a divided world that rank 0 sends to all other ranks: the world without the bodies
/// that single ranks own. Kinematic bodies stay, because every rank has them.
std::vector<std::byte> bytes_without_bodies(const WorldState& state) {
    World world = copy_of_settled(state, {});
    WorldState& copy = WorldAccess::state_of(world);
    const WholeWorld& whole = state.ranks.whole;
    copy.ranks.world_row = state.ranks.world_row;
    copy.ranks.whole.joining_world_row = whole.joining_world_row;
    copy.ranks.whole.records.resize(whole.size());
    std::vector<std::uint8_t> kept;
    for (const Index world_row : copy.ranks.world_row) kept.push_back(whole.owner[world_row] == WholeWorld::everywhere);
    replace_rows(copy, kept, {}, [](std::uint64_t) { return false; });
    copy.ranks = {};
    copy.model.disabled_pairs.key.clear();  // their keys name bodies that are absent here
    return world.to_bytes();
}

/// Divides the world of rank 0, sends all other ranks their bodies, and drops those that rank 0 does not hold.
std::vector<BodyExtent> send_parts(World& world, Ranks& ranks, const RankSettings& settings) {
    std::vector<BodyExtent> extents;
    RankMessage facts;
    try {
        extents = choose_parts(world, ranks, settings);
    } catch (const SceneError& error) {
        put_value(std::string(error.what()), facts);
        message_of_first(ranks, facts);
        throw;
    }
    WorldState& state = WorldAccess::state_of(world);
    WholeWorld& whole = state.ranks.whole;
    put_value(std::string(), facts);
    for_each_fact(whole, extents, state.model, [&](const auto& fact) { put_value(fact, facts); });
    for (const std::vector<Index>& rows_of_slots : whole.joining_world_row) put_value(rows_of_slots, facts);
    state.model.for_each_joining([&](const char*, auto&, const auto& map) {
        put_value(map.names.size(), facts);
        for (const auto& [handle, name] : map.names) {
            put_value(handle.slot, facts);
            put_value(name, facts);
        }
    });
    for (const BodyRecord& record : state.model.body_records) put_value(record.name, facts);
    message_of_first(ranks, facts);
    const auto held_by = [&](int rank) {
        std::vector<std::uint8_t> held;
        for (const std::vector<int>& holders : whole.holders) held.push_back(std::ranges::binary_search(holders, rank));
        return held;
    };
    for (int rank = 1; rank < ranks.size(); ++rank)
        for (Index batch = 0; batch < batches; ++batch) {
            const RankMessage bodies = message_of_batch(state, held_by(rank), batch, rank, true);
            RankMessage answer;
            ranks.exchange({&rank, 1}, {&bodies, 1}, {&answer, 1});
        }
    std::vector<std::uint8_t> kept = held_by(0);
    for (std::size_t b = 0; b < kept.size(); ++b) kept[b] |= whole.owner[b] == WholeWorld::everywhere;
    replace_rows(state, kept, {}, [&](std::uint64_t pair) { return whole.pair_owner(pair, whole.owner) == 0; });
    message_of_first(ranks, bytes_without_bodies(state));
    return extents;
}

/// On ranks other than 0: replaces the world by the part that rank 0 sends. Keeps the backend, the number of threads
/// and the step callback of this rank.
std::vector<BodyExtent> receive_part(World& world, Ranks& ranks, const RankSettings& settings) {
    const RankMessage facts = message_of_first(ranks, {});
    MailReader reader(facts);
    std::string refusal;
    take_value(reader, refusal);
    if (!refusal.empty()) throw SceneError(refusal);
    const Settings own = world.settings();
    std::function<void(const StepReport&)> step_watch = std::move(WorldAccess::state_of(world).record.step_watch);
    world = World(own);  // frees bodies that the caller has added
    std::vector<BodyRows> rows;
    for (Index batch = 0; batch < batches; ++batch) {
        constexpr int first = 0;
        const RankMessage answer;
        RankMessage bodies;
        ranks.exchange({&first, 1}, {&answer, 1}, {&bodies, 1});
        rows.push_back(rows_of_message(bodies));
    }
    world = World::from_bytes(message_of_first(ranks, {}), {.backend = own.backend, .threads = own.threads});
    WorldState& state = WorldAccess::state_of(world);
    state.record.step_watch = std::move(step_watch);
    WholeWorld& whole = state.ranks.whole;
    std::vector<BodyExtent> extents;
    for_each_fact(whole, extents, state.model, [&](auto& fact) { take_value(reader, fact); });
    state.model.for_each_joining(
        [&](const char*, auto&, auto&) { take_value(reader, whole.joining_world_row.emplace_back()); });
    take_value(reader, whole.joining_world_row.emplace_back());  // last list: attachments
    state.model.for_each_joining([&](const char*, auto&, auto& map) {
        for (auto count = reader.take<std::size_t>(); count > 0; --count) {
            const auto slot = reader.take<std::uint32_t>();
            take_value(reader, map.names[map.handle_of_slot(slot)]);
        }
    });
    for (std::size_t world_row = 0; world_row < whole.size(); ++world_row) {
        std::string name;
        take_value(reader, name);
        whole.records.push_back(record_of_name(std::move(name)));
        if (whole.owner[world_row] == WholeWorld::everywhere)
            state.ranks.world_row.push_back(static_cast<Index>(world_row));
    }
    join_ranks(state.ranks, ranks, settings, state.record.counters.steps);
    whole.holders = find_holding_ranks(whole, whole.owner, extents, ranks.size());
    const std::vector<std::uint8_t> all(state.ranks.world_row.size(), 1);
    replace_rows(state, all, rows, [](std::uint64_t) { return true; });
    return extents;
}

/// Returns the complete world on rank 0, and nothing on other ranks. `state`: the part of this rank.
std::optional<World> gather_parts(WorldState& state) {
    const RankState& rank_state = state.ranks;
    std::vector<std::uint8_t> sent;
    for (const Index world_row : rank_state.world_row)
        sent.push_back(rank_state.whole.owner[world_row] == rank_state.rank);
    std::vector<BodyRows> added;
    for (Index batch = 0; batch < batches; ++batch) {
        const std::vector<RankMessage> bodies = rank_state.ranks->gather(
            rank_state.rank == 0 ? RankMessage() : message_of_batch(state, sent, batch, rank_state.rank, false));
        for (std::size_t rank = 1; rank < bodies.size(); ++rank) added.push_back(rows_of_message(bodies[rank]));
    }
    if (rank_state.rank != 0) return std::nullopt;
    World whole = copy_of_settled(state, {});
    WorldState& copy = WorldAccess::state_of(whole);
    copy.ranks.world_row = rank_state.world_row;
    copy.ranks.whole = rank_state.whole;
    std::vector<std::uint8_t> kept;
    for (const Index world_row : rank_state.world_row) {
        const std::int32_t owner = rank_state.whole.owner[world_row];
        kept.push_back(owner == rank_state.rank || owner == WholeWorld::everywhere);
    }
    replace_rows(copy, kept, added, [](std::uint64_t) { return true; });
    sort_self_crossings(copy);
    copy.ranks = {};
    note_ghosts(copy);
    copy.model.of_ranks = {};
    return whole;
}

}  // namespace

void distribute(World& world, Ranks& ranks, const RankSettings& settings) {
    WorldState& undivided = WorldAccess::state_of(world);
    undivided.require_between_steps("distribute");
    if (undivided.ranks.on())
        refuse_division("world", "a world that is already divided", "an undivided world",
                        "call distribute() only once");
    if (ranks.size() == 1) return require_divisible(undivided);
    // Sets the floating-point mode of advance(), so that the elements chosen here for implicit integration are the same
    // as there.
    const ArithmeticScope arithmetic;
    act_together(&ranks, [&] {
        const std::vector<BodyExtent> extents =
            ranks.rank() == 0 ? send_parts(world, ranks, settings) : receive_part(world, ranks, settings);
        WorldState& state = WorldAccess::state_of(world);
        note_holders(state.ranks, extents);
        note_ghosts(state);
        list_step_again(state);
    });
}

std::optional<World> gathered(const World& world) {
    // tables can be read only through mutable references; no row is changed
    WorldState& state = WorldAccess::state_of(const_cast<World&>(world));
    if (!state.ranks.on()) return world.clone();
    std::optional<World> whole;
    act_together(state.ranks.ranks, [&] { whole = gather_parts(state); });
    return whole;
}

}  // namespace skerry
