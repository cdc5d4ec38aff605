#include "tests/ranks/everywhere.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "components/pair_table.h"
#include "components/union_find.h"
#include "engine/world/step/step.h"
#include "engine/world/world_state.h"

namespace skerry::test {

namespace {

void for_each_column(auto& table, auto&& visit) {
    table.for_each_column(visit);
}
void for_each_column(PairTable& table, auto&& visit) {
    table.for_each_row_column(visit);
}

/// Appends the rows of `from` to `into`.
template <class Table>
void append(Table& into, Table& from) {
    std::vector<const void*> columns;
    for_each_column(from, [&](const char*, auto& column, ColumnRole) { columns.push_back(&column); });
    std::size_t next = 0;
    for_each_column(into, [&]<class Rows>(const char*, Rows& column, ColumnRole) {
        for (const auto& row : *static_cast<const Rows*>(columns[next++])) column.push_back(row);
    });
}

/// Sorts the rows of a table by their keys.
template <class Key>
void sort_rows(auto& table, const Column<Key>& key) {
    std::vector<std::size_t> order(key.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t row) { return key[row]; });
    for_each_column(table, [&]<class Rows>(const char*, Rows& column, ColumnRole) {
        if (column.size() != order.size()) return;
        const Rows unsorted = column;
        for (std::size_t row = 0; row < order.size(); ++row) column[row] = unsorted[order[row]];
    });
}

/// Joins the contact memories of all ranks into that of an undivided world.
ContactCache joined_memory(std::vector<std::optional<World>>& worlds) {
    ContactCache all;
    for (std::optional<World>& world : worlds) {
        ContactCache& part = WorldAccess::state_of(*world).cache;
        append(all.warm_start, part.warm_start);
        if (all.warm_start.step.size() > 1) all.warm_start.step.resize(1);
        append(all.resting, part.resting);
        append(all.pairs, part.pairs);
    }
    const Column<ContactKey> warm = all.warm_start.key, resting = all.resting.contact.key;
    const Column<std::uint64_t> pairs = all.pairs.key;
    sort_rows(all.warm_start, warm);
    sort_rows(all.resting, resting);
    sort_rows(all.pairs, pairs);
    return all;
}

}  // namespace

void hold_everywhere(World& world, Ranks& ranks) {
    WorldState& state = WorldAccess::state_of(world);
    note_changed_seams(state.model);
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
    list_step_again(state);
}

std::vector<std::uint64_t> hashes_everywhere(int count, const std::function<World()>& make,
                                             const std::function<void(World&)>& run) {
    std::vector<std::optional<World>> worlds(static_cast<std::size_t>(count));
    run_on_ranks(count, [&](Ranks& ranks) {
        std::optional<World>& world = worlds[static_cast<std::size_t>(ranks.rank())];
        world.emplace(make());
        hold_everywhere(*world, ranks);
        run(*world);
    });
    const ContactCache memory = joined_memory(worlds);
    std::vector<std::uint64_t> hashes;
    for (std::optional<World>& world : worlds) {
        WorldAccess::state_of(*world).cache = memory;
        hashes.push_back(world->state_hash());
    }
    return hashes;
}

}  // namespace skerry::test
