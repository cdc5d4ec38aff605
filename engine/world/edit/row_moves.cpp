#include "engine/world/edit/row_moves.h"

namespace skerry {

namespace {

bool is_marked(std::span<const std::uint8_t> marks, std::size_t row) {
    return row < marks.size() && marks[row] != 0;
}

/// Numbers the remaining rows of a table. `removed`: receives the removed rows. `row_now`: receives the new number of
/// each row, or no_index for a removed row.
void number_rows(std::size_t count, auto&& is_removed, std::vector<Range>& removed, std::vector<Index>& row_now) {
    Index next = 0;
    for (std::size_t row = 0; row < count; ++row) {
        const auto index = static_cast<Index>(row);
        const bool goes = is_removed(row);
        if (goes) append_gone(Range{index, index + 1}, removed);
        row_now.push_back(goes ? no_index : next++);
    }
}

}  // namespace

std::vector<std::vector<AnyColumn>> columns_by_body_table(Model& model) {
    const auto all = [](AnyTable table) {
        std::vector<AnyColumn> columns;
        for (const ColumnInfo& info : table.columns()) columns.push_back(table.column(info));
        return columns;
    };
    SurfaceTables& surface = model.surface;
    return {all(model.bodies),        all(model.nodes),         all(model.node_blocks),    all(model.elements),
            all(model.element_nodes), all(surface.edges),       all(model.tetrahedra),     all(surface.triangles),
            all(surface.vertices),    all(model.bvh),           {surface.vertex_triangle}, all(model.bvh_leaves),
            all(model.rigid_bodies),  all(model.implicit_nodes)};
}

OfBodyTables<Range> rows_of_body(const Model& model, std::size_t body) {
    const BodyTable& table = model.bodies;
    const auto row = static_cast<Index>(body);
    OfBodyTables<Range> rows;
    rows.bodies = {row, row + 1};
    rows.nodes = table.nodes[body];
    rows.node_blocks = table.node_blocks[body];
    rows.blocks = table.blocks[body];
    rows.element_nodes = table.element_nodes[body];
    rows.tetrahedron_blocks = table.tetrahedron_blocks[body];
    rows.triangles = table.triangles[body];
    rows.edges = table.edges[body];
    rows.vertices = table.vertices[body];
    rows.bvh_nodes = table.bvh_nodes[body];
    rows.bvh_leaves = table.bvh_leaves[body];
    rows.rigid = table.rigid[body];
    rows.implicit = table.implicit[body];
    const VertexTable& vertices = model.surface.vertices;
    if (rows.vertices.size() > 0)
        rows.vertex_triangles = {vertices.triangle_begin[static_cast<std::size_t>(rows.vertices.begin)],
                                 vertices.triangle_end[static_cast<std::size_t>(rows.vertices.end) - 1]};
    return rows;
}

RowMoves row_moves(const Model& model, std::span<const std::uint8_t> bodies, std::span<const std::uint8_t> colliders) {
    RowMoves moves;
    const auto body_goes = [&](std::size_t row) { return is_marked(bodies, row); };
    number_rows(model.bodies.slot.size(), body_goes, moves.removed.bodies, moves.body_now);
    number_rows(
        model.colliders.slot.size(), [&](std::size_t row) { return is_marked(colliders, row); },
        moves.removed_colliders, moves.collider_now);
    number_rows(
        model.attachments.slot.size(),
        [&](std::size_t row) { return body_goes(static_cast<std::size_t>(model.attachments.body[row])); },
        moves.removed_attachments, moves.attachment_now);

    constexpr auto range_of = OfBodyTables<Range>::members();
    constexpr auto index_of = OfBodyTables<Index>::members();
    constexpr auto list_of = OfBodyTables<std::vector<Range>>::members();
    moves.removed.bodies.clear();
    OfBodyTables<Index> shift;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        moves.shift_to_start.push_back(shift);
        if (!body_goes(b)) continue;
        const OfBodyTables<Range> rows = rows_of_body(model, b);
        for (std::size_t table = 0; table < range_of.size(); ++table) {
            append_gone(rows.*range_of[table], moves.removed.*list_of[table]);
            shift.*index_of[table] += (rows.*range_of[table]).size();
        }
    }
    return moves;
}

}  // namespace skerry
