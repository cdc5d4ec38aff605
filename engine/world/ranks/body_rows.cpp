#include "engine/world/ranks/body_rows.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/world/edit/erase_gone.h"
#include "engine/world/edit/joining_rows.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/save/saved_sets.h"
#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Appends rows of a column to another column of the same type. Parts of the range beyond the last row are left out.
void append_rows(AnyColumn from, Range rows, AnyColumn to) {
    const auto begin = static_cast<std::size_t>(rows.begin), end = static_cast<std::size_t>(rows.end);
    if (begin >= std::min(end, from.size())) return;
    const std::size_t count = std::min(end, from.size()) - begin, first = to.size(), bytes = from.type().bytes;
    to.resize(first + count);
    std::memcpy(to.write() + first * bytes, from.read() + begin * bytes, count * bytes);
}

/// Appends a row to all columns that have one row per row of the table.
void append_row(AnyTable from, std::size_t row, AnyTable to) {
    for (const ColumnInfo& info : from.columns())
        if (info.has_row_each)
            append_rows(from.column(info), {static_cast<Index>(row), static_cast<Index>(row) + 1}, to.column(info));
}

/// Appends a row with its lists of entries (lists_of).
template <class Table>
void append_row_with_lists(Table& from, std::size_t row, Table& to) {
    append_row(from, row, to);
    const std::vector<RowLists> old = lists_of(from), fresh = lists_of(to);
    for (std::size_t list = 0; list < old.size(); ++list) {
        const Range entries = (*old[list].rows)[row];
        const auto begin = static_cast<Index>(fresh[list].columns.front().size());
        for (std::size_t c = 0; c < old[list].columns.size(); ++c)
            append_rows(old[list].columns[c], entries, fresh[list].columns[c]);
        fresh[list].rows->back() = {begin, begin + entries.size()};
    }
}

/// A model of which a new model gets rows.
struct Source {
    Model* model;
    std::span<const Index> place;
    std::span<const std::uint8_t> marked;  // by row of BodyTable: nonzero for a body that the new model gets; empty: all
    Index watched, kept;                   // StepWatch::body and StepWatch::kept
    StepEvaluation look;
    bool gives_common;                     // true: also gives the rows that join no body
    RowMoves moves{};   // new numbers of the rows; the lists of removed rows are not set
    std::vector<std::vector<AnyColumn>> columns = columns_by_body_table(*model);

    bool gives(std::size_t body) const { return marked.empty() || marked[body] != 0; }
};

/// A row of one of the sources, and its place in the order of the new rows.
struct Pick {
    Index order;
    std::size_t source, row;
};

/// Builds the tables of a model from rows of other models, in the order of the undivided world.
class Composition {
public:
    Composition(std::span<Source> sources, const WholeWorld& whole, Model& to)
        : sources_(sources), whole_(whole), to_(to) {}

    Column<Index> run() {
        pick_bodies();
        for (const Pick& pick : picks_) append_body(pick);
        append_clusters();
        append_watch();
        append_attachments();
        append_joining_rows();
        return std::move(place_);
    }

private:
    void pick_bodies() {
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            Source& from = sources_[s];
            from.moves.body_now.assign(from.place.size(), no_index);
            from.moves.down.resize(from.place.size());
            for (std::size_t b = 0; b < from.place.size(); ++b)
                if (from.gives(b)) picks_.push_back({from.place[b], s, b});
        }
        std::ranges::sort(picks_, {}, &Pick::order);
        for (std::size_t row = 0; row < picks_.size(); ++row) {
            place_.push_back(picks_[row].order);
            sources_[picks_[row].source].moves.body_now[picks_[row].row] = static_cast<Index>(row);
        }
    }

    void append_body(const Pick& pick) {
        Source& source = sources_[pick.source];
        constexpr auto range_of = OfBodyTables<Range>::members();
        constexpr auto index_of = OfBodyTables<Index>::members();
        const OfBodyTables<Range> old = rows_of_body(*source.model, pick.row);
        OfBodyTables<Range> rows;
        OfBodyTables<Index>& down = source.moves.down[pick.row];
        const std::size_t new_row = to_.bodies.slot.size();
        for (std::size_t table = 0; table < columns_.size(); ++table) {
            const Range of_old = old.*range_of[table];
            const auto begin = static_cast<Index>(columns_[table].front().size());
            for (std::size_t c = 0; c < columns_[table].size(); ++c)
                append_rows(source.columns[table][c], of_old, columns_[table][c]);
            rows.*range_of[table] = {begin, begin + of_old.size()};
            down.*index_of[table] = of_old.begin - begin;
        }
        renumber_rows_of_body(to_, new_row, rows, down);
    }

    void append_clusters() {
        std::vector<Pick> picks;
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const NodeClusters& from = sources_[s].model->clusters;
            for (std::size_t c = 0; c < from.size(); ++c)
                if (const Index row = sources_[s].moves.body_now[static_cast<std::size_t>(from.body[c])]; row != no_index)
                    picks.push_back({row, s, c});
        }
        if (picks.empty()) return;
        std::ranges::stable_sort(picks, {}, &Pick::order);
        NodeClusters& clusters = to_.clusters;
        clusters.cluster_of.resize(to_.nodes.position.size(), no_index);
        clusters.place.resize(to_.nodes.position.size(), no_index);
        for (const Pick& pick : picks) {
            const Source& source = sources_[pick.source];
            const NodeClusters& from = source.model->clusters;
            const std::span<const Index> old = std::as_const(from.nodes)[pick.row];
            const Index down = source.moves.down[static_cast<std::size_t>(from.body[pick.row])].nodes;
            std::vector<Index> nodes(old.begin(), old.end());
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                nodes[i] -= down;
                clusters.cluster_of[nodes[i]] = static_cast<Index>(clusters.size());
                clusters.place[nodes[i]] = static_cast<Index>(i);
            }
            append(std::span<const Index>(nodes), clusters.nodes);
            clusters.body.push_back(pick.order);
            clusters.first_entry.push_back(clusters.inverse.size());
            const auto first = static_cast<Index>(from.first_entry[pick.row]);
            const auto entries = static_cast<Index>(nodes.size() * nodes.size());
            append_rows(source.model->clusters.inverse, {first, first + entries}, clusters.inverse);
        }
    }

    /// Appends the progress of the checks of stable steps. The checks of all ranks have proceeded to the same place.
    void append_watch() {
        StepWatch& watch = to_.watch;
        for (const Pick& pick : picks_) {
            const Source& source = sources_[pick.source];
            StepWatch& from = source.model->watch;
            const auto row = static_cast<Index>(pick.row);
            const Range nodes = source.model->bodies.nodes[pick.row];
            append_rows(from.position, nodes, watch.position);
            append_rows(from.stiffness_sum, nodes, watch.stiffness_sum);
            append_rows(from.step, {row, row + 1}, watch.step);
        }
        const auto first_row = [&](auto&& is_open) {
            return static_cast<Index>(std::ranges::find_if(picks_, is_open) - picks_.begin());
        };
        watch.body = first_row([&](const Pick& p) { return static_cast<Index>(p.row) >= sources_[p.source].watched; });
        watch.kept = first_row([&](const Pick& p) { return static_cast<Index>(p.row) >= sources_[p.source].kept; });
        if (watch.body < static_cast<Index>(picks_.size()))
            if (const Pick& next = picks_[static_cast<std::size_t>(watch.body)];
                static_cast<Index>(next.row) == sources_[next.source].watched)
                watch.look = sources_[next.source].look;
        if (watch.step.size() == picks_.size() && watch.position.size() == to_.nodes.position.size()) return;
        watch = {};
    }

    void append_attachments() {
        std::vector<Pick> picks;
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const AttachmentTable& table = sources_[s].model->attachments;
            for (std::size_t a = 0; a < table.slot.size(); ++a)
                if (sources_[s].moves.body_now[static_cast<std::size_t>(table.body[a])] != no_index)
                    picks.push_back({order_of(whole_.joining_place.back(), table.slot[a]), s, a});
        }
        std::ranges::stable_sort(picks, {}, &Pick::order);
        AttachmentTable& to = to_.attachments;
        for (const Pick& pick : picks) {
            const Source& source = sources_[pick.source];
            AttachmentTable& from = source.model->attachments;
            append_row_with_lists(from, pick.row, to);
            MotionScript& script = to.script.back();
            const Range keys{script.key_begin, script.key_end};
            script.key_begin = static_cast<Index>(to.keyframe.size());
            script.key_end = script.key_begin + keys.size();
            append_rows(from.keyframe, keys, to.keyframe);
            const auto body = static_cast<std::size_t>(to.body.back());
            for (Index& node : rows_of(to.node, to.nodes.back())) node -= source.moves.down[body].nodes;
            to.body.back() = source.moves.body_now[body];
        }
    }

    /// Order of a row with a handle slot; rows without a handle come last.
    static Index order_of(std::span<const Index> place_of_slot, std::uint32_t slot) {
        return slot < place_of_slot.size() ? place_of_slot[slot] : std::numeric_limits<Index>::max();
    }

    void append_joining_rows() {
        std::size_t number = 0;
        to_.for_each_joining([&]<class Table>(const char*, Table& to, auto&) {
            const std::span<const Index> place_of_slot = whole_.joining_place[number++];
            std::vector<Pick> picks;
            std::vector<std::vector<Index>> row_now(sources_.size());
            std::vector<Table*> tables;
            for (std::size_t s = 0; s < sources_.size(); ++s) {
                Table& from = table_like(to, *sources_[s].model);
                tables.push_back(&from);
                row_now[s].assign(from.slot.size(), no_index);
                for (const std::size_t row : rows_given(from, sources_[s]))
                    picks.push_back({order_of(place_of_slot, from.slot[row]), s, row});
            }
            std::ranges::stable_sort(picks, {}, &Pick::order);
            for (std::size_t row = 0; row < picks.size(); ++row) {
                append_row_with_lists(*tables[picks[row].source], picks[row].row, to);
                row_now[picks[row].source][picks[row].row] = static_cast<Index>(row);
            }
            for_each_joined(to, ColumnRole::body, [&](std::size_t row, Index& body) {
                body = sources_[picks[row].source].moves.body_now[static_cast<std::size_t>(body)];
            });
            if constexpr (requires { to.leader; })
                for (std::size_t row = 0; row < picks.size(); ++row)
                    if (to.leader[row] != no_index)
                        to.leader[row] = row_now[picks[row].source][static_cast<std::size_t>(to.leader[row])];
        });
    }

    template <class Table>
    static Table& table_like(const Table&, Model& model) {
        Table* found = nullptr;
        model.for_each_joining([&](const char*, auto& table, auto&) {
            if constexpr (std::is_same_v<std::remove_reference_t<decltype(table)>, Table>) found = &table;
        });
        return *found;
    }

    /// Rows that join a body that the source gives. The world itself also gives the rows that join no body.
    template <class Table>
    static std::vector<std::size_t> rows_given(Table& table, const Source& source) {
        std::vector<std::uint8_t> gives(table.slot.size(), source.gives_common ? 1 : 0);
        for_each_joined(table, ColumnRole::body, [&](std::size_t row, Index body) {
            gives[row] = source.moves.body_now[static_cast<std::size_t>(body)] != no_index;
        });
        std::vector<std::size_t> rows;
        for (std::size_t row = 0; row < gives.size(); ++row)
            if (gives[row]) rows.push_back(row);
        return rows;
    }

    std::span<Source> sources_;
    const WholeWorld& whole_;
    Model& to_;
    std::vector<std::vector<AnyColumn>> columns_ = columns_by_body_table(to_);
    std::vector<Pick> picks_;  // by new row of BodyTable
    Column<Index> place_;
};

/// Copies the rows of a table for which wants(row) is true to the end of another table.
void copy_rows(AnyTable from, std::size_t count, auto&& wants, AnyTable to) {
    for (std::size_t row = 0; row < count; ++row)
        if (wants(row)) append_row(from, row, to);
}

/// Converts between the rows of a rank and places, which are the same on all ranks. Nodes are then numbered within
/// their bodies; a node of the second body has the number ~n.
class PlacesOfContacts {
public:
    PlacesOfContacts(const Model& model, std::span<const Index> place) : model_(model), place_(place) {}

    void to_places(ContactTable& contacts) const {
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            for (Index& node : contacts.stencil[c].node) {
                const Index body = model_.nodes.body[node];
                node -= first_node(body);
                if (body != contacts.first_body[c]) node = ~node;
            }
            contacts.first_body[c] = place(contacts.first_body[c]);
            contacts.second_body[c] = place(contacts.second_body[c]);
        }
    }
    void to_rows(ContactTable& contacts) const {
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            contacts.first_body[c] = row(contacts.first_body[c]);
            contacts.second_body[c] = row(contacts.second_body[c]);
            for (Index& node : contacts.stencil[c].node)
                node = node < 0 ? first_node(contacts.second_body[c]) + ~node : first_node(contacts.first_body[c]) + node;
        }
    }
    void to_places(PairTable& pairs) const {
        for (std::size_t p = 0; p < pairs.size(); ++p) convert(pairs, p, [&](Index of) { return place(of); });
    }
    void to_rows(PairTable& pairs) const {
        for (std::size_t p = 0; p < pairs.size(); ++p) convert(pairs, p, [&](Index of) { return row(of); });
    }

private:
    static void convert(PairTable& pairs, std::size_t p, auto&& number) {
        pairs.first[p] = number(pairs.first[p]);
        if (pairs.kind[p] != PairKind::collider) pairs.second[p] = number(pairs.second[p]);
    }
    Index first_node(Index body) const { return model_.bodies.nodes[body].begin; }
    Index place(Index row) const { return row == no_index ? no_index : place_[static_cast<std::size_t>(row)]; }
    Index row(Index place) const {
        return place == no_index ? no_index : static_cast<Index>(std::ranges::lower_bound(place_, place) - place_.begin());
    }

    const Model& model_;
    std::span<const Index> place_;
};

/// Copies all rows of contacts of pairs for which wants(key) is true.
void copy_contacts(ContactTable& from, const WantsPair& wants, ContactTable& to) {
    copy_rows(from, from.size(), [&](std::size_t c) { return wants(from.key[c].pair); }, to);
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
    if (!from.step.empty() && !to.key.empty()) to.step = from.step;
}

/// Order in which the rows of a key column ascend.
template <class Key>
std::vector<std::size_t> ascending(const Column<Key>& key) {
    std::vector<std::size_t> order(key.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t row) { return key[row]; });
    return order;
}

/// Brings the rows of a table into an order. Columns of another length stay unchanged.
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

/// Brings lists by row into an order. Rows without a list get an empty one.
void reorder_lists(std::span<const std::size_t> order, auto& lists) {
    auto old = std::move(lists);
    lists.clear();
    lists.resize(order.size());
    for (std::size_t row = 0; row < order.size(); ++row)
        if (order[row] < old.size()) std::swap(lists[row], old[order[row]]);
}

}  // namespace

BodyRows rows_of_bodies(WorldState& world, std::span<const std::uint8_t> marked, const WantsPair& wants_pair) {
    BodyRows rows;
    Model& model = world.model;
    std::array<Source, 1> source{{{.model = &model,
                                   .place = world.ranks.place,
                                   .marked = marked,
                                   .watched = model.watch.body,
                                   .kept = model.watch.kept,
                                   .look = model.watch.look,
                                   .gives_common = false}}};
    rows.place = Composition(source, world.ranks.whole, rows.model).run();
    rows.watch.push_back({rows.model.watch.body, rows.model.watch.kept, rows.model.watch.look});
    const Column<Real>& valid_until = world.cache.search.body_valid_until;
    for (std::size_t b = 0; b < world.ranks.place.size(); ++b)
        if (marked[b] != 0) rows.valid_until.push_back(b < valid_until.size() ? valid_until[b] : SearchState::forgotten);
    const PlacesOfContacts places(model, world.ranks.place);
    ContactCache& cache = world.cache;
    copy_warm_start(cache.warm_start, wants_pair, rows.warm_start);
    copy_rows(cache.resting, cache.resting.size(),
              [&](std::size_t c) { return wants_pair(cache.resting.contact.key[c].pair); }, rows.resting);
    places.to_places(rows.resting.contact);
    copy_rows(cache.pairs, cache.pairs.size(),
              [&](std::size_t p) {
                  return cache.pairs.state[p] == PairState::overlapping && wants_pair(cache.pairs.key[p]);
              },
              rows.pairs);
    places.to_places(rows.pairs);
    copy_contacts(world.scratch.contacts, wants_pair, rows.contacts);
    places.to_places(rows.contacts);
    return rows;
}

namespace {

/// Rows of a table that are not wanted any more, as ascending ranges.
std::vector<Range> unwanted(std::size_t count, auto&& wants) {
    std::vector<Range> gone;
    for (std::size_t row = 0; row < count; ++row)
        if (!wants(row)) append_gone(Range{static_cast<Index>(row), static_cast<Index>(row) + 1}, gone);
    return gone;
}

/// Moves the tables of bodies, attachments and joining rows to another model.
void move_tables(Model& from, Model& to) {
    to.bodies = std::move(from.bodies);
    to.nodes = std::move(from.nodes);
    to.node_blocks = std::move(from.node_blocks);
    to.tetrahedra = std::move(from.tetrahedra);
    to.elements = std::move(from.elements);
    to.element_nodes = std::move(from.element_nodes);
    to.rigid_bodies = std::move(from.rigid_bodies);
    to.implicit_nodes = std::move(from.implicit_nodes);
    to.surface = std::move(from.surface);
    to.bvh = std::move(from.bvh);
    to.bvh_leaves = std::move(from.bvh_leaves);
    to.clusters = std::move(from.clusters);
    to.attachments = std::move(from.attachments);
    to.joints = std::move(from.joints);
    to.surface_sets = std::move(from.surface_sets);
    to.ties = std::move(from.ties);
    to.cables = std::move(from.cables);
    to.cavities = std::move(from.cavities);
    to.pipes = std::move(from.pipes);
    to.fibres = std::move(from.fibres);
    to.loads = std::move(from.loads);
    to.springs = std::move(from.springs);
    to.watch.body = from.watch.body;
    to.watch.kept = from.watch.kept;
    to.watch.look = from.watch.look;
    to.watch.position = std::move(from.watch.position);
    to.watch.stiffness_sum = std::move(from.watch.stiffness_sum);
    to.watch.step = std::move(from.watch.step);
    to.watch.first_piece.clear();
}

/// Lets the handles of a table refer to its present rows. Handles of absent rows keep their slots. `slot`: by row.
void find_rows_of_handles(auto& map, std::size_t count_before, std::span<const std::uint32_t> slot) {
    map.rows_moved(std::vector<Index>(count_before, no_index));
    for (std::size_t row = 0; row < slot.size(); ++row)
        if (slot[row] != no_slot) map.rename(map.handle_of_slot(slot[row]), static_cast<Index>(row));
}

/// Adapts all data that refer to rows of bodies, and computes all data that are not stored. `before`: the old tables.
class RowsReplaced {
public:
    RowsReplaced(WorldState& world, Model& before, std::span<const Index> place_before, const RowMoves& moves)
        : world_(world), model_(world.model), before_(before), place_before_(place_before), moves_(moves) {}

    void handles_and_links() const {
        Column<std::uint32_t> slots = model_.bodies.slot;
        for (std::size_t b = 0; b < slots.size(); ++b)
            if (model_.bodies.kind[b] == BodyKind::kinematic) slots[b] = no_slot;
        find_rows_of_handles(model_.body_map, before_.bodies.slot.size(), slots);
        find_rows_of_handles(model_.attachment_map, before_.attachments.slot.size(), model_.attachments.slot);
        std::vector<std::size_t> counts;
        before_.for_each_joining([&](const char*, auto& table, auto&) { counts.push_back(table.slot.size()); });
        std::size_t number = 0;
        model_.for_each_joining([&](const char*, auto& table, auto& map) {
            find_rows_of_handles(map, counts[number++], table.slot);
        });
        for (Index& body : model_.colliders.body)
            if (body != no_index) body = moves_.body_now[static_cast<std::size_t>(body)];
    }

    void records() const {
        std::vector<BodyRecord>& store = world_.ranks.whole.records;
        for (std::size_t b = 0; b < place_before_.size(); ++b)
            store[static_cast<std::size_t>(place_before_[b])] = std::move(model_.body_records[b]);
        model_.body_records.clear();
        for (const Index place : world_.ranks.place)
            model_.body_records.push_back(std::move(store[static_cast<std::size_t>(place)]));
    }

    void derived_columns() const {
        StiffBodies stiff(model_.rigid_bodies.size());
        for (std::size_t b = 0; b < moves_.body_now.size(); ++b) {
            if (moves_.body_now[b] == no_index || before_.bodies.implicit[b].size() == 0) continue;
            const Index row = before_.bodies.rigid[b].begin;
            stiff[static_cast<std::size_t>(row - moves_.down[b].rigid)] =
                std::move(model_.stiff_bodies[static_cast<std::size_t>(row)]);
        }
        model_.stiff_bodies = std::move(stiff);
        model_.known_elements.clear();
        model_.patches = {};
        model_.body_mass.clear();
        model_.extend_derived();
        model_.loaded_bodies = 0;
        std::vector<std::uint8_t> is_old(model_.bodies.slot.size(), 0);
        for (const Index row : moves_.body_now)
            if (row != no_index) is_old[static_cast<std::size_t>(row)] = 1;
        for (std::size_t b = 0; b < is_old.size(); ++b) {
            model_.note_loads(b, false);
            if (!is_old[b] && model_.bodies.implicit[b].size() > 0) model_.stiffen(b);
        }
        find_holders(model_);
        note_forces(model_);
        model_.links_open = true;
        note_changed_seams(model_);
    }

    /// Lets the next step search all pairs.
    void search() const {
        SearchState& state = world_.cache.search;
        const std::size_t count = model_.bodies.slot.size();
        Column<Real> valid_until;
        // Finite, so that the next step searches all pairs without forgetting those that are known.
        valid_until.resize(count, std::numeric_limits<Real>::lowest());
        Column<Vec3> origin;
        if (!world_.cache.pairs.self.origin.empty()) origin.resize(model_.nodes.position.size(), Vec3::Zero());
        for (std::size_t b = 0; b < moves_.body_now.size(); ++b) {
            const Index row = moves_.body_now[b];
            if (row == no_index) continue;
            if (!(b < state.body_valid_until.size()) || state.body_valid_until[b] == SearchState::forgotten)
                valid_until[row] = SearchState::forgotten;
            if (!origin.empty())
                std::ranges::copy(rows_of(world_.cache.pairs.self.origin, before_.bodies.nodes[b]),
                                  rows_of(origin, model_.bodies.nodes[row]).begin());
        }
        state.body_valid_until = std::move(valid_until);
        world_.cache.pairs.self.origin = std::move(origin);
        state.memory.rebase.assign(count, 0);
        if (state.memory.any_unmeasured) state.memory.body_unmeasured.assign(count, 1);
    }

private:
    WorldState& world_;
    Model& model_;
    Model& before_;
    std::span<const Index> place_before_;
    const RowMoves& moves_;
};

/// Removes contact data of pairs for which `keeps` is false, and renumbers the others.
void keep_contacts(const RowMoves& moves, std::span<const Index> body_of_node, const WantsPair& keeps,
                   WorldState& world) {
    ContactCache& cache = world.cache;
    PairTable& pairs = cache.pairs;
    // pairs of removed bodies are removed first, so that only lists of remaining pairs are renumbered
    erase_gone(moves, body_of_node, cache);
    erase_gone(moves, body_of_node, world.scratch.contacts);
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

/// Adds contact data that came with bodies. Tables stay in the order of their keys.
void add_contacts(std::span<BodyRows> added, WorldState& world) {
    const PlacesOfContacts places(world.model, world.ranks.place);
    ContactCache& cache = world.cache;
    WarmStartTable& warm = cache.warm_start;
    ContactTable& contacts = world.scratch.contacts;
    PairTable& pairs = cache.pairs;
    const auto everything = [](auto) { return true; };
    pairs.candidates.resize(pairs.size());  // lists beyond the last row are spare memory
    pairs.asleep_until.resize(pairs.size());
    pairs.leaf_pairs.resize(pairs.size());
    for (BodyRows& rows : added) {
        copy_warm_start(rows.warm_start, everything, warm);
        places.to_rows(rows.resting.contact);
        copy_rows(rows.resting, rows.resting.size(), everything, cache.resting);
        places.to_rows(rows.contacts);
        copy_contacts(rows.contacts, everything, contacts);
        places.to_rows(rows.pairs);
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

}  // namespace

void replace_rows(WorldState& world, std::span<const std::uint8_t> kept, std::span<BodyRows> added,
                  const WantsPair& keeps_pair) {
    Model& model = world.model;
    RankState& ranks = world.ranks;
    const Column<Index> place_before = ranks.place;
    std::vector<Source> sources{{.model = &model,
                                 .place = place_before,
                                 .marked = kept,
                                 .watched = model.watch.body,
                                 .kept = model.watch.kept,
                                 .look = model.watch.look,
                                 .gives_common = true}};
    for (BodyRows& rows : added)
        sources.push_back({.model = &rows.model,
                           .place = rows.place,
                           .marked = {},
                           .watched = rows.watch[0].body,
                           .kept = rows.watch[0].kept,
                           .look = rows.watch[0].look,
                           .gives_common = false});
    Model fresh;
    ranks.place = Composition(sources, ranks.whole, fresh).run();
    RowMoves& moves = sources[0].moves;
    moves.collider_now.resize(model.colliders.slot.size());
    std::iota(moves.collider_now.begin(), moves.collider_now.end(), Index{0});
    keep_contacts(moves, model.nodes.body, keeps_pair, world);
    Model before;
    move_tables(model, before);
    move_tables(fresh, model);
    const RowsReplaced replaced(world, before, place_before, moves);
    replaced.handles_and_links();
    replaced.records();
    replaced.derived_columns();
    replaced.search();
    for (std::size_t s = 1; s < sources.size(); ++s)
        for (std::size_t b = 0; b < added[s - 1].valid_until.size(); ++b)
            if (added[s - 1].valid_until[b] == SearchState::forgotten)
                world.cache.search.body_valid_until[sources[s].moves.body_now[b]] = SearchState::forgotten;
    add_contacts(added, world);
    world.scratch.regions = RegionTable{};
    world.scratch.self_crossing_places.resize(model.bodies.slot.size());
    world.query_trees.forget();
    world.record.contact_view_is_current = false;
}

namespace {

/// Calls visit(column) for each column of the rows.
void for_each_column(BodyRows& rows, auto&& visit) {
    const auto visit_all = [&](AnyTable table) {
        for (const ColumnInfo& info : table.columns()) visit(table.column(info));
    };
    for (const AnyTable& table : rows.model.tables()) visit_all(table);
    NodeClusters& clusters = rows.model.clusters;
    for (const AnyColumn& column :
         {AnyColumn(clusters.nodes.offset), AnyColumn(clusters.nodes.item), AnyColumn(clusters.body),
          AnyColumn(clusters.first_entry), AnyColumn(clusters.inverse), AnyColumn(clusters.cluster_of),
          AnyColumn(clusters.place), AnyColumn(rows.model.watch.position), AnyColumn(rows.model.watch.stiffness_sum),
          AnyColumn(rows.model.watch.step), AnyColumn(rows.place), AnyColumn(rows.watch), AnyColumn(rows.valid_until)})
        visit(column);
    visit_all(rows.warm_start);
    visit_all(rows.resting);
    visit_all(rows.pairs);
    visit_all(rows.contacts);
}

void append_bytes(const void* from, std::size_t count, RankMessage& to) {
    const auto* const bytes = static_cast<const std::byte*>(from);
    to.insert(to.end(), bytes, bytes + count);
}

}  // namespace

RankMessage message_of(BodyRows& rows) {
    RankMessage message;
    for_each_column(rows, [&](const AnyColumn& column) {
        const std::uint64_t count = column.size();
        append_bytes(&count, sizeof count, message);
        append_bytes(column.read(), count * column.type().bytes, message);
    });
    return message;
}

BodyRows rows_of_message(std::span<const std::byte>& message) {
    BodyRows rows;
    const auto take = [&](void* to, std::size_t count) {
        if (count > 0) std::memcpy(to, message.data(), count);
        message = message.subspan(count);
    };
    for_each_column(rows, [&](const AnyColumn& column) {
        std::uint64_t count = 0;
        take(&count, sizeof count);
        column.resize(count);
        take(column.write(), count * column.type().bytes);
    });
    return rows;
}

}  // namespace skerry
