#include "engine/world/ranks/rows/moved_contacts.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "components/check.h"
#include "engine/world/edit/erase_gone.h"
#include "engine/world/ranks/rows/compose_rows.h"

namespace skerry {

namespace {

/// Copies the rows of a table for which wants(row) is true to the end of another table.
void copy_rows(AnyTable from, std::size_t count, auto&& wants, AnyTable to) {
    for (std::size_t row = 0; row < count; ++row)
        if (wants(row)) append_row(from, row, to);
}

/// Converts rows of this rank to numbers that are valid on all ranks, and back. The number of a body is its row in the
/// undivided world; the number of node n of the first body is n, of node n of the second body ~n.
class WorldRowsOfContacts {
public:
    WorldRowsOfContacts(const Model& model, std::span<const Index> row_in_world)
        : model_(model), world_row_(row_in_world) {}

    void to_world_rows(ContactTable& contacts) const {
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            for (Index& node : contacts.stencil[c].node) {
                const Index body = model_.nodes.body[node];
                node -= first_node(body);
                if (body != contacts.first_body[c]) node = ~node;
            }
            contacts.first_body[c] = world_row(contacts.first_body[c]);
            contacts.second_body[c] = world_row(contacts.second_body[c]);
        }
    }
    void to_rows(ContactTable& contacts) const {
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            contacts.first_body[c] = row(contacts.first_body[c]);
            contacts.second_body[c] = row(contacts.second_body[c]);
            for (Index& node : contacts.stencil[c].node)
                node =
                    node < 0 ? first_node(contacts.second_body[c]) + ~node : first_node(contacts.first_body[c]) + node;
        }
    }
    void to_world_rows(PairTable& pairs) const {
        for (std::size_t p = 0; p < pairs.size(); ++p) convert(pairs, p, [&](Index body) { return world_row(body); });
    }
    void to_rows(PairTable& pairs) const {
        for (std::size_t p = 0; p < pairs.size(); ++p) convert(pairs, p, [&](Index body) { return row(body); });
    }

private:
    static void convert(PairTable& pairs, std::size_t p, auto&& number) {
        pairs.first[p] = number(pairs.first[p]);
        if (pairs.kind[p] != PairKind::collider) pairs.second[p] = number(pairs.second[p]);
    }
    Index first_node(Index body) const { return model_.bodies.nodes[body].begin; }
    Index world_row(Index row) const { return row == no_index ? no_index : world_row_[static_cast<std::size_t>(row)]; }
    Index row(Index row_in_world) const {
        return row_in_world == no_index ? no_index : local_row(world_row_, row_in_world);
    }

    const Model& model_;
    std::span<const Index> world_row_;
};

/// Copies all contacts of pairs for which wants(key) is true.
void copy_rows_of_pairs(ContactTable& from, const WantsPair& wants, ContactTable& to) {
    copy_rows(
        from, from.size(), [&](std::size_t c) { return wants(from.key[c].pair); }, to);
}

void copy_warm_start(WarmStartTable& from, const WantsPair& wants, WarmStartTable& to) {
    const auto copy = [&](auto& column, auto& of_to) {
        for (std::size_t row = 0; row < column.size(); ++row)
            if (wants(from.key[row].pair)) of_to.push_back(column[row]);
    };
    copy(from.impulse, to.impulse);
    copy(from.normal, to.normal);
    copy(from.point, to.point);
    copy(from.key, to.key);
    SKERRY_CHECK(to.point.empty() || to.point.size() == to.key.size());
    if (!from.step.empty() && !to.key.empty()) to.step = from.step;
}

/// Row numbers of a column of keys, in ascending order of the keys.
template <class Key>
std::vector<std::size_t> ascending(const Column<Key>& key) {
    std::vector<std::size_t> order(key.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t row) { return key[row]; });
    return order;
}

/// Reorders the rows of a table: new row k is old row order[k]. Columns whose length is not that of `order`, such as
/// lists, stay unchanged.
void reorder(std::span<const std::size_t> order, AnyTable table) {
    for (const ColumnInfo& info : table.columns()) {
        const AnyColumn column = table.column(info);
        if (!info.has_row_each || column.size() != order.size()) continue;
        const std::size_t bytes = column.type().bytes;
        const std::vector<std::byte> old(column.read(), column.read() + column.size() * bytes);
        std::byte* to = column.write();
        for (const std::size_t row : order) {
            std::memcpy(to, old.data() + row * bytes, bytes);
            to += bytes;
        }
    }
}

/// Reorders `lists`, which has one list per row, like reorder(). Rows without a list get an empty one.
void reorder_lists(std::span<const std::size_t> order, auto& lists) {
    auto old = std::move(lists);
    lists.clear();
    lists.resize(order.size());
    for (std::size_t row = 0; row < order.size(); ++row)
        if (order[row] < old.size()) std::swap(lists[row], old[order[row]]);
}

/// Rows of a table for which wants(row) is false, as ascending ranges.
std::vector<Range> unwanted(std::size_t count, auto&& wants) {
    std::vector<Range> removed;
    for (std::size_t row = 0; row < count; ++row)
        if (!wants(row)) append_gone(Range{static_cast<Index>(row), static_cast<Index>(row) + 1}, removed);
    return removed;
}

/// Renumbers crossings that earlier attempts at the present step have found. Removes those of bodies without a new row.
void renumber_crossings(const RowMoves& moves, std::span<const Index> body_of_node, Column<ContactRow>& crossings) {
    const auto now = [&](Index body) {
        return body == no_index ? no_index : moves.body_now[static_cast<std::size_t>(body)];
    };
    Column<ContactRow> kept;
    for (ContactRow row : crossings) {
        if (now(row.first_body) == no_index || (row.second_body != no_index && now(row.second_body) == no_index))
            continue;
        for (Index& node : row.stencil.node)
            node -= moves.shift_to_start[static_cast<std::size_t>(body_of_node[static_cast<std::size_t>(node)])].nodes;
        row.first_body = now(row.first_body);
        row.second_body = now(row.second_body);
        kept.push_back(row);
    }
    crossings = std::move(kept);
}

}  // namespace

void copy_contacts(WorldState& world, const WantsPair& wants, BodyRows& to) {
    const WorldRowsOfContacts converter(world.model, world.ranks.world_row);
    ContactCache& cache = world.cache;
    copy_warm_start(cache.warm_start, wants, to.warm_start);
    copy_rows(
        cache.resting, cache.resting.size(), [&](std::size_t c) { return wants(cache.resting.contact.key[c].pair); },
        to.resting);
    converter.to_world_rows(to.resting.contact);
    copy_rows(
        cache.pairs, cache.pairs.size(),
        [&](std::size_t p) { return cache.pairs.state[p] == PairState::overlapping && wants(cache.pairs.key[p]); },
        to.pairs);
    converter.to_world_rows(to.pairs);
    copy_rows_of_pairs(world.scratch.contacts, wants, to.contacts);
    converter.to_world_rows(to.contacts);
}

void keep_contacts(const RowMoves& moves, std::span<const Index> body_of_node, const WantsPair& keeps,
                   WorldState& world) {
    ContactCache& cache = world.cache;
    PairTable& pairs = cache.pairs;
    erase_gone(moves, body_of_node, cache);
    erase_gone(moves, body_of_node, world.scratch.contacts);
    renumber_crossings(moves, body_of_node, cache.crossings.row);
    const auto erase = [&](const Column<ContactKey>& key, AnyTable table) {
        table.erase(unwanted(key.size(), [&](std::size_t row) { return keeps(key[row].pair); }));
    };
    WarmStartTable& warm = cache.warm_start;
    const Column<Real> step = warm.step;
    erase(warm.key, warm);
    warm.step = step;
    if (warm.key.empty()) warm.step.clear();
    erase(cache.resting.contact.key, cache.resting);
    erase(world.scratch.contacts.key, world.scratch.contacts);
    std::vector<std::size_t> order;
    for (std::size_t p = 0; p < pairs.size(); ++p)
        if (keeps(pairs.key[p])) order.push_back(p);
    if (order.size() == pairs.size()) return;
    reorder_lists(order, pairs.candidates);
    reorder_lists(order, pairs.asleep_until);
    reorder_lists(order, pairs.leaf_pairs);
    AnyTable(pairs).erase(unwanted(pairs.size(), [&](std::size_t p) { return keeps(pairs.key[p]); }));
}

void add_contacts(std::span<BodyRows> added, WorldState& world) {
    const WorldRowsOfContacts converter(world.model, world.ranks.world_row);
    ContactCache& cache = world.cache;
    WarmStartTable& warm = cache.warm_start;
    ContactTable& contacts = world.scratch.contacts;
    PairTable& pairs = cache.pairs;
    const auto everything = [](auto) { return true; };
    pairs.candidates.resize(pairs.size());  // removes lists beyond the last row, which are spare memory
    pairs.asleep_until.resize(pairs.size());
    pairs.leaf_pairs.resize(pairs.size());
    for (BodyRows& rows : added) {
        copy_warm_start(rows.warm_start, everything, warm);
        converter.to_rows(rows.resting.contact);
        copy_rows(rows.resting, rows.resting.size(), everything, cache.resting);
        converter.to_rows(rows.contacts);
        copy_rows_of_pairs(rows.contacts, everything, contacts);
        converter.to_rows(rows.pairs);
        std::ranges::fill(rows.pairs.valid_until, SearchState::forgotten);
        copy_rows(rows.pairs, rows.pairs.size(), everything, pairs);
    }
    reorder(ascending(warm.key), warm);
    reorder(ascending(cache.resting.contact.key), cache.resting);
    reorder(ascending(contacts.key), contacts);
    const std::vector<std::size_t> order = ascending(pairs.key);
    reorder(order, pairs);
    reorder_lists(order, pairs.candidates);
    reorder_lists(order, pairs.asleep_until);
    reorder_lists(order, pairs.leaf_pairs);
}

}  // namespace skerry
