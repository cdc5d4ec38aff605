#include "engine/world/ranks/rows/body_rows.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/ranks/rows/compose_rows.h"
#include "engine/world/ranks/rows/moved_contacts.h"
#include "engine/world/ranks/rows/put_record.h"
#include "engine/world/step/step.h"

namespace skerry {

BodyRows rows_of_bodies(WorldState& world, std::span<const std::uint8_t> marked, const WantsPair& wants_pair) {
    BodyRows rows;
    Model& model = world.model;
    std::array<RowSource, 1> source{{{.model = &model,
                                      .world_row = world.ranks.world_row,
                                      .marked = marked,
                                      .watched = model.watch.body,
                                      .kept = model.watch.kept,
                                      .evaluation = model.watch.evaluation,
                                      .gives_common = false}}};
    rows.world_row = compose_rows(source, world.ranks.whole, rows.model);
    rows.watch.push_back({rows.model.watch.body, rows.model.watch.kept, rows.model.watch.evaluation});
    const Column<Real>& valid_until = world.cache.search.body_valid_until;
    for (std::size_t b = 0; b < world.ranks.world_row.size(); ++b)
        if (marked[b] != 0)
            rows.valid_until.push_back(b < valid_until.size() ? valid_until[b] : SearchState::forgotten);
    copy_contacts(world, wants_pair, rows);
    for (const SelfCrossing& found : world.record.self_crossings) {
        const Index row = model.body_map.row(found.body);
        if (row != no_index && marked[static_cast<std::size_t>(row)] != 0)
            rows.self_crossings.push_back({found.body.slot, found.self_contact, found.first_time, found.last_time,
                                           found.last_places, found.most_places});
    }
    rows.enabled_pairs = world.ranks.enabled_pairs;
    return rows;
}

void copy_records(const Model& model, std::span<const std::uint8_t> marked, BodyRows& to) {
    for (std::size_t b = 0; b < marked.size(); ++b)
        if (marked[b] != 0) to.records.push_back(model.body_records[b]);
}

namespace {

/// Moves the tables of bodies, of attachments and of rows that join bodies to another model.
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
    to.watch.evaluation = from.watch.evaluation;
    to.watch.position = std::move(from.watch.position);
    to.watch.stiffness_sum = std::move(from.watch.stiffness_sum);
    to.watch.step = std::move(from.watch.step);
    to.watch.first_piece.clear();
}

/// Finds bodies whose old rows are replaced by added rows, and maps their old rows to the new ones, so that data that
/// refer to these bodies remain valid. Returns a mark for each new row: 1 for such a body.
std::vector<std::uint8_t> find_exchanged(std::span<const OfBodyTables<Range>> rows_before,
                                         std::span<const Index> world_row_before, const Model& now,
                                         std::span<const Index> world_row_now, RowMoves& moves) {
    constexpr auto range_of = OfBodyTables<Range>::members();
    constexpr auto index_of = OfBodyTables<Index>::members();
    std::vector<std::uint8_t> exchanged(world_row_now.size(), 0);
    for (std::size_t b = 0; b < world_row_before.size(); ++b) {
        if (moves.body_now[b] != no_index) continue;
        moves.body_now[b] = local_row(world_row_now, world_row_before[b]);
        if (moves.body_now[b] == no_index) continue;
        const auto row = static_cast<std::size_t>(moves.body_now[b]);
        exchanged[row] = 1;
        const OfBodyTables<Range> old = rows_before[b], fresh = rows_of_body(now, row);
        for (std::size_t table = 0; table < range_of.size(); ++table)
            moves.shift_to_start[b].*index_of[table] = (old.*range_of[table]).begin - (fresh.*range_of[table]).begin;
    }
    return exchanged;
}

/// Makes the next step search each pair with a marked body again. A list of contact candidates (features that may
/// touch) is valid until BodyTable::travel of the bodies has grown by a given distance, but another rank has measured
/// `travel` of the marked bodies.
void forget_candidates(std::span<const std::uint8_t> marked, PairTable& pairs) {
    for (std::size_t p = 0; p < pairs.size(); ++p)
        if (marked[static_cast<std::size_t>(pairs.first[p])] ||
            (pairs.kind[p] != PairKind::collider && marked[static_cast<std::size_t>(pairs.second[p])]))
            pairs.valid_until[p] = SearchState::forgotten;
}

/// Lets the handles of a table refer to its present rows. Handles of rows on other ranks keep their slots.
/// `count_before`: number of rows before the tables were replaced. `slot`: slot of each present row.
void find_rows_of_handles(auto& map, std::size_t count_before, std::span<const std::uint32_t> slot) {
    map.rows_moved(std::vector<Index>(count_before, no_index));
    for (std::size_t row = 0; row < slot.size(); ++row)
        if (slot[row] != no_slot) map.rename(map.handle_of_slot(slot[row]), static_cast<Index>(row));
}

/// Adapts all data that refer to rows of bodies, and computes all derived data again. `before`: the old tables.
class RowsReplaced {
public:
    RowsReplaced(WorldState& world, Model& before, std::span<const Index> world_row_before, const RowMoves& moves)
        : world_(world), model_(world.model), before_(before), world_row_before_(world_row_before), moves_(moves) {}

    void handles_and_links() const {
        Column<std::uint32_t> slots = model_.bodies.slot;
        for (std::size_t b = 0; b < slots.size(); ++b)
            if (model_.bodies.kind[b] == BodyKind::kinematic) slots[b] = no_slot;
        find_rows_of_handles(model_.body_map, before_.bodies.slot.size(), slots);
        find_rows_of_handles(model_.attachment_map, before_.attachments.slot.size(), model_.attachments.slot);
        std::vector<std::size_t> counts;
        before_.for_each_joining([&](const char*, auto& table, auto&) { counts.push_back(table.slot.size()); });
        std::size_t number = 0;
        model_.for_each_joining(
            [&](const char*, auto& table, auto& map) { find_rows_of_handles(map, counts[number++], table.slot); });
        for (Index& body : model_.colliders.body)
            if (body != no_index) body = moves_.body_now[static_cast<std::size_t>(body)];
    }

    void records(std::span<BodyRows> added) const {
        std::vector<BodyRecord>& store = world_.ranks.whole.records;
        const auto record = [&](Index world_row) -> BodyRecord& { return store[static_cast<std::size_t>(world_row)]; };
        for (std::size_t b = 0; b < world_row_before_.size(); ++b)
            record(world_row_before_[b]) = std::move(model_.body_records[b]);
        for (BodyRows& rows : added)
            for (std::size_t b = 0; b < rows.records.size(); ++b)
                record(rows.world_row[b]) = std::move(rows.records[b]);
        model_.body_records.clear();
        for (const Index world_row : world_.ranks.world_row)
            model_.body_records.push_back(std::move(record(world_row)));
        if (world_.ranks.rank == 0) return;
        for (const Index world_row : world_row_before_)
            if (world_.ranks.row_of(world_row) == no_index)
                record(world_row) = record_of_name(std::move(record(world_row).name));
    }

    void derived_columns() const {
        StiffBodies stiff(model_.rigid_bodies.size());
        for (std::size_t b = 0; b < moves_.body_now.size(); ++b) {
            if (moves_.body_now[b] == no_index || before_.bodies.implicit[b].size() == 0) continue;
            const Index row = before_.bodies.rigid[b].begin;
            stiff[static_cast<std::size_t>(row - moves_.shift_to_start[b].rigid)] =
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
        find_holding_attachments(model_);
        note_forces(model_);
        model_.forced |= model_.of_ranks.forced;
        model_.links_open = true;
        note_changed_seams(model_);
    }

    /// Lets the next step search all pairs.
    void search() const {
        SearchState& state = world_.cache.search;
        const std::size_t count = model_.bodies.slot.size();
        Column<Real> valid_until;
        // The lowest finite number makes the next step search all pairs. Unlike SearchState::forgotten, it keeps the
        // candidates that are known.
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
    std::span<const Index> world_row_before_;
    const RowMoves& moves_;
};

/// Enables the collisions of pairs that another rank has enabled after the ties between the bodies had broken
/// (release_ties).
void enable_pairs(std::span<const std::uint64_t> keys, WorldState& world) {
    Column<std::uint64_t>& disabled = world.model.disabled_pairs.key;
    Column<std::uint64_t>& known = world.ranks.enabled_pairs;
    for (const std::uint64_t key : keys) {
        if (std::ranges::find(known, key) != known.end()) continue;
        known.push_back(key);
        const auto found = std::lower_bound(disabled.begin(), disabled.end(), key);
        if (found != disabled.end() && *found == key)
            disabled.erase(static_cast<std::size_t>(found - disabled.begin()), 1);
    }
}

/// Stores the self-crossings that came with added bodies. They replace the entries of this rank, because the sender has
/// made the later checks.
void take_self_crossings(std::span<const FoundSelfCrossing> added, WorldState& world) {
    std::vector<SelfCrossing>& crossings = world.record.self_crossings;
    for (const FoundSelfCrossing& found : added) {
        const BodyHandle body = world.model.body_map.handle_of_slot(found.slot);
        auto entry = std::ranges::find(crossings, body, &SelfCrossing::body);
        if (entry == crossings.end()) {
            const auto row = static_cast<std::size_t>(world.model.body_map.row(body));
            entry = crossings.insert(entry, {.body = body, .name = world.model.body_records[row].name});
        }
        entry->self_contact = found.self_contact;
        entry->first_time = found.first_time;
        entry->last_time = found.last_time;
        entry->last_places = found.last_places;
        entry->most_places = found.most_places;
    }
}

}  // namespace

void replace_rows(WorldState& world, std::span<const std::uint8_t> kept, std::span<BodyRows> added,
                  const WantsPair& keeps_pair) {
    Model& model = world.model;
    RankState& ranks = world.ranks;
    // Copies of data that are needed below: compose_rows frees all tables of bodies except BodyTable, and
    // ranks.world_row is overwritten.
    const Column<Index> world_row_before = ranks.world_row, body_of_node = model.nodes.body;
    std::vector<OfBodyTables<Range>> rows_before;
    for (std::size_t b = 0; b < world_row_before.size(); ++b) rows_before.push_back(rows_of_body(model, b));
    std::vector<RowSource> sources{{.model = &model,
                                    .world_row = world_row_before,
                                    .marked = kept,
                                    .watched = model.watch.body,
                                    .kept = model.watch.kept,
                                    .evaluation = model.watch.evaluation,
                                    .gives_common = true,
                                    .is_used_up = true}};
    for (BodyRows& rows : added)
        sources.push_back({.model = &rows.model,
                           .world_row = rows.world_row,
                           .marked = {},
                           .watched = rows.watch[0].body,
                           .kept = rows.watch[0].kept,
                           .evaluation = rows.watch[0].evaluation,
                           .gives_common = false,
                           .is_used_up = true});
    Model fresh;
    ranks.world_row = compose_rows(sources, ranks.whole, fresh);
    RowMoves& moves = sources[0].moves;
    const std::vector<std::uint8_t> exchanged =
        find_exchanged(rows_before, world_row_before, fresh, ranks.world_row, moves);
    moves.collider_now.resize(model.colliders.slot.size());
    std::iota(moves.collider_now.begin(), moves.collider_now.end(), Index{0});
    keep_contacts(moves, body_of_node, keeps_pair, world);
    forget_candidates(exchanged, world.cache.pairs);
    Model before;
    move_tables(model, before);
    move_tables(fresh, model);
    const RowsReplaced replaced(world, before, world_row_before, moves);
    replaced.handles_and_links();
    replaced.records(added);
    replaced.derived_columns();
    replaced.search();
    for (std::size_t s = 1; s < sources.size(); ++s)
        for (std::size_t b = 0; b < added[s - 1].valid_until.size(); ++b)
            if (added[s - 1].valid_until[b] == SearchState::forgotten)
                world.cache.search.body_valid_until[sources[s].moves.body_now[b]] = SearchState::forgotten;
    add_contacts(added, world);
    for (const BodyRows& rows : added) {
        enable_pairs(rows.enabled_pairs, world);
        take_self_crossings(rows.self_crossings, world);
    }
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
          AnyColumn(clusters.index_in_cluster), AnyColumn(rows.model.watch.position),
          AnyColumn(rows.model.watch.stiffness_sum), AnyColumn(rows.model.watch.step), AnyColumn(rows.world_row),
          AnyColumn(rows.watch), AnyColumn(rows.valid_until), AnyColumn(rows.self_crossings),
          AnyColumn(rows.enabled_pairs)})
        visit(column);
    visit_all(rows.warm_start);
    visit_all(rows.resting);
    visit_all(rows.pairs);
    visit_all(rows.contacts);
}

}  // namespace

RankMessage message_of(BodyRows& rows) {
    RankMessage message;
    for_each_column(rows, [&](const AnyColumn& column) {
        const std::uint64_t count = column.size();
        put_value(count, message);
        put_rows(std::span<const std::byte>(column.read(), count * column.type().bytes), message);
    });
    put_value(rows.records.size(), message);
    for (const BodyRecord& record : rows.records) put_record(record, message);
    return message;
}

BodyRows rows_of_message(std::span<const std::byte> message) {
    BodyRows rows;
    MailReader reader(message);
    for_each_column(rows, [&](const AnyColumn& column) {
        const auto count = reader.take<std::uint64_t>();
        column.resize(count);
        reader.take_rows(std::span(column.write(), count * column.type().bytes));
    });
    rows.records.resize(reader.take<std::size_t>());
    for (BodyRecord& record : rows.records) record = take_record(reader);
    SKERRY_CHECK(reader.at_end());
    return rows;
}

}  // namespace skerry
