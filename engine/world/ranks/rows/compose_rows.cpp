#include "engine/world/ranks/rows/compose_rows.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "engine/world/edit/erase_gone.h"
#include "engine/world/edit/joining_rows.h"
#include "engine/world/save/saved_sets.h"

namespace skerry {

namespace {

/// Bytes of the rows in a range, without rows beyond the end of the column.
std::span<const std::byte> bytes_of_rows(AnyColumn column, Range rows) {
    const auto begin = static_cast<std::size_t>(rows.begin), end = static_cast<std::size_t>(rows.end);
    const std::size_t has = std::min(end, column.size()), bytes = column.type().bytes;
    if (begin >= has) return {};
    return {column.read() + begin * bytes, (has - begin) * bytes};
}

/// Appends rows of a column to another column of the same type. Parts of the range beyond the last row are left out.
void append_rows(AnyColumn from, Range rows, AnyColumn to) {
    const std::span<const std::byte> added = bytes_of_rows(from, rows);
    const std::size_t first = to.size(), bytes = to.type().bytes;
    to.resize(first + added.size() / bytes);
    if (!added.empty()) std::memcpy(to.write() + first * bytes, added.data(), added.size());
}

/// Appends a row of a table, and the lists of entries that belong to it (lists_of).
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

/// Presents a single column as a table, because free_column() works on tables.
struct ColumnTable {
    Column<Index>& column;
    void for_each_column(auto&& visit) { visit("", column); }
};

/// Frees a column of a table. `number`: number of the column in the order of for_each_column.
void free_column(std::size_t number, auto& table) {
    table.for_each_column([&](const char*, auto& column, auto...) {
        if (number-- == 0) column = {};
    });
}

/// Frees a column that columns_by_body_table lists at [table][number]. The arguments of free_in must be in the order of
/// that list.
void free_column(std::size_t table, std::size_t number, Model& model) {
    SurfaceTables& surface = model.surface;
    const auto free_in = [&](auto&... tables) {
        std::size_t index = 0;
        ((index++ == table ? free_column(number, tables) : void()), ...);
    };
    ColumnTable vertex_triangle{surface.vertex_triangle};
    free_in(model.bodies, model.nodes, model.node_blocks, model.elements, model.element_nodes, surface.edges,
            model.tetrahedra, surface.triangles, surface.vertices, model.bvh, vertex_triangle, model.bvh_leaves,
            model.rigid_bodies, model.implicit_nodes);
}

/// Row `row` of the source with the index `source`. New rows are sorted by `order`.
struct Pick {
    Index order;
    std::size_t source, row;
};

/// Builds the tables of a model from rows of other models, in the order of the undivided world.
class Composition {
public:
    Composition(std::span<RowSource> sources, const WholeWorld& whole, Model& to)
        : sources_(sources), whole_(whole), to_(to) {}

    Column<Index> run() {
        pick_bodies();
        append_bodies();
        append_clusters();
        append_watch();
        append_attachments();
        append_joining_rows();
        return std::move(world_row_);
    }

private:
    void pick_bodies() {
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            RowSource& row_source = sources_[s];
            row_source.moves.body_now.assign(row_source.world_row.size(), no_index);
            row_source.moves.shift_to_start.resize(row_source.world_row.size());
            for (std::size_t b = 0; b < row_source.world_row.size(); ++b)
                if (row_source.gives(b)) picks_.push_back({row_source.world_row[b], s, b});
        }
        std::ranges::sort(picks_, {}, &Pick::order);
        for (std::size_t row = 0; row < picks_.size(); ++row) {
            world_row_.push_back(picks_[row].order);
            sources_[picks_[row].source].moves.body_now[picks_[row].row] = static_cast<Index>(row);
        }
    }

    /// Appends the bodies column by column, so that each column of a source can be freed before the next one is copied.
    void append_bodies() {
        constexpr auto range_of = OfBodyTables<Range>::members();
        constexpr auto index_of = OfBodyTables<Index>::members();
        const auto shift_of = [&](const Pick& pick) -> OfBodyTables<Index>& {
            return sources_[pick.source].moves.shift_to_start[pick.row];
        };
        std::vector<OfBodyTables<Range>> old, now(picks_.size());
        for (const Pick& pick : picks_) old.push_back(rows_of_body(*sources_[pick.source].model, pick.row));
        for (std::size_t table = 0; table < columns_.size(); ++table) {
            Index end = 0;
            for (std::size_t row = 0; row < picks_.size(); ++row) {
                const Range rows = old[row].*range_of[table];
                now[row].*range_of[table] = {end, end + rows.size()};
                shift_of(picks_[row]).*index_of[table] = rows.begin - end;
                end += rows.size();
            }
            for (std::size_t c = 0; c < columns_[table].size(); ++c) {
                append_column(table, c, old);
                for (const RowSource& source : sources_)
                    if (source.is_used_up && table != 0) free_column(table, c, *source.model);
            }
        }
        for (std::size_t row = 0; row < picks_.size(); ++row)
            renumber_rows_of_body(to_, row, now[row], shift_of(picks_[row]));
    }

    /// Fills column `c` of a table with the rows of all picked bodies. `rows`: for each picked body, its rows in the
    /// tables of its source.
    void append_column(std::size_t table, std::size_t c, std::span<const OfBodyTables<Range>> rows) {
        constexpr auto range_of = OfBodyTables<Range>::members();
        std::vector<std::span<const std::byte>> parts;
        std::size_t total = 0;
        for (std::size_t row = 0; row < picks_.size(); ++row) {
            parts.push_back(bytes_of_rows(sources_[picks_[row].source].columns[table][c], rows[row].*range_of[table]));
            total += parts.back().size();
        }
        const AnyColumn to = columns_[table][c];
        to.resize(total / to.type().bytes);  // resized at once, so that the column does not grow in steps
        std::byte* end = to.write();
        for (const std::span<const std::byte> part : parts) {
            if (!part.empty()) std::memcpy(end, part.data(), part.size());
            end += part.size();
        }
    }

    void append_clusters() {
        std::vector<Pick> picks;
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const NodeClusters& from = sources_[s].model->clusters;
            for (std::size_t c = 0; c < from.size(); ++c)
                if (const Index row = sources_[s].moves.body_now[static_cast<std::size_t>(from.body[c])];
                    row != no_index)
                    picks.push_back({row, s, c});
        }
        if (picks.empty()) return;
        std::ranges::stable_sort(picks, {}, &Pick::order);
        NodeClusters& clusters = to_.clusters;
        clusters.cluster_of.resize(to_.nodes.position.size(), no_index);
        clusters.index_in_cluster.resize(to_.nodes.position.size(), no_index);
        for (const Pick& pick : picks) {
            const RowSource& source = sources_[pick.source];
            const NodeClusters& from = source.model->clusters;
            const std::span<const Index> old = std::as_const(from.nodes)[pick.row];
            const Index shift = source.moves.shift_to_start[static_cast<std::size_t>(from.body[pick.row])].nodes;
            std::vector<Index> nodes(old.begin(), old.end());
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                nodes[i] -= shift;
                clusters.cluster_of[nodes[i]] = static_cast<Index>(clusters.size());
                clusters.index_in_cluster[nodes[i]] = static_cast<Index>(i);
            }
            append(std::span<const Index>(nodes), clusters.nodes);
            clusters.body.push_back(pick.order);
            clusters.first_entry.push_back(clusters.inverse.size());
            const auto first = static_cast<Index>(from.first_entry[pick.row]);
            const auto entries = static_cast<Index>(nodes.size() * nodes.size());
            append_rows(source.model->clusters.inverse, {first, first + entries}, clusters.inverse);
        }
    }

    /// Appends the progress of the evaluation of stable steps (StepWatch), which visits one body after the other. All
    /// ranks have come equally far in the order of the undivided world. So the evaluation goes on at the first row that
    /// its source had not yet finished.
    void append_watch() {
        StepWatch& watch = to_.watch;
        for (const Pick& pick : picks_) {
            const RowSource& source = sources_[pick.source];
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
                watch.evaluation = sources_[next.source].evaluation;
        if (watch.step.size() == picks_.size() && watch.position.size() == to_.nodes.position.size()) return;
        watch = {};
    }

    void append_attachments() {
        std::vector<Pick> picks;
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            const AttachmentTable& table = sources_[s].model->attachments;
            for (std::size_t a = 0; a < table.slot.size(); ++a)
                if (sources_[s].moves.body_now[static_cast<std::size_t>(table.body[a])] != no_index)
                    picks.push_back({order_of(whole_.joining_world_row.back(), table.slot[a]), s, a});
        }
        std::ranges::stable_sort(picks, {}, &Pick::order);
        AttachmentTable& to = to_.attachments;
        for (const Pick& pick : picks) {
            const RowSource& source = sources_[pick.source];
            AttachmentTable& from = source.model->attachments;
            append_row_with_lists(from, pick.row, to);
            MotionScript& script = to.script.back();
            const Range keys{script.key_begin, script.key_end};
            script.key_begin = static_cast<Index>(to.keyframe.size());
            script.key_end = script.key_begin + keys.size();
            append_rows(from.keyframe, keys, to.keyframe);
            const auto body = static_cast<std::size_t>(to.body.back());
            for (Index& node : rows_of(to.node, to.nodes.back())) node -= source.moves.shift_to_start[body].nodes;
            to.body.back() = source.moves.body_now[body];
        }
    }

    /// Number by which a row is sorted: its row in the undivided world. Rows without a handle come last.
    static Index order_of(std::span<const Index> world_row_of_slot, std::uint32_t slot) {
        return slot < world_row_of_slot.size() ? world_row_of_slot[slot] : std::numeric_limits<Index>::max();
    }

    void append_joining_rows() {
        std::size_t number = 0;
        to_.for_each_joining([&]<class Table>(const char*, Table& to, auto&) {
            const std::span<const Index> world_row_of_slot = whole_.joining_world_row[number++];
            std::vector<Pick> picks;
            std::vector<std::vector<Index>> row_now(sources_.size());
            std::vector<Table*> tables;
            for (std::size_t s = 0; s < sources_.size(); ++s) {
                Table& from = table_like(to, *sources_[s].model);
                tables.push_back(&from);
                row_now[s].assign(from.slot.size(), no_index);
                for (const std::size_t row : rows_given(from, sources_[s]))
                    picks.push_back({order_of(world_row_of_slot, from.slot[row]), s, row});
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

    /// Rows of a table (such as that of joints or loads) to copy from a source: those that refer to a body that is
    /// copied from this source. A source with gives_common also provides the rows that refer to no body.
    template <class Table>
    static std::vector<std::size_t> rows_given(Table& table, const RowSource& source) {
        std::vector<std::uint8_t> gives(table.slot.size(), source.gives_common ? 1 : 0);
        for_each_joined(table, ColumnRole::body, [&](std::size_t row, Index body) {
            gives[row] = source.moves.body_now[static_cast<std::size_t>(body)] != no_index;
        });
        std::vector<std::size_t> rows;
        for (std::size_t row = 0; row < gives.size(); ++row)
            if (gives[row]) rows.push_back(row);
        return rows;
    }

    std::span<RowSource> sources_;
    const WholeWorld& whole_;
    Model& to_;
    std::vector<std::vector<AnyColumn>> columns_ = columns_by_body_table(to_);
    std::vector<Pick> picks_;  // by new row of BodyTable
    Column<Index> world_row_;
};

}  // namespace

Column<Index> compose_rows(std::span<RowSource> sources, const WholeWorld& whole, Model& to) {
    return Composition(sources, whole, to).run();
}

void append_row(AnyTable from, std::size_t row, AnyTable to) {
    for (const ColumnInfo& info : from.columns())
        if (info.has_row_each)
            append_rows(from.column(info), {static_cast<Index>(row), static_cast<Index>(row) + 1}, to.column(info));
}

}  // namespace skerry
