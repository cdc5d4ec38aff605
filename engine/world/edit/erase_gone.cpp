#include "engine/world/edit/erase_gone.h"

#include <algorithm>

#include "components/any_table.h"
#include "engine/world/edit/joining_rows.h"
#include "systems/dynamics/elements/build_elements.h"

namespace skerry {

namespace {

void lower(Index& row, Index by) {
    if (row != no_index) row -= by;
}
void lower(Range& range, Index by) {
    range.begin -= by;
    range.end -= by;
}

/// Renumbers the references between rows of one body, in all tables.
class RowsOfBody {
public:
    RowsOfBody(Model& model, std::size_t body, const OfBodyTables<Range>& has, const OfBodyTables<Index>& shift)
        : model_(model), body_(body), has_(has), shift_(shift) {}

    void renumber() const {
        nodes();
        elements();
        surface();
        tree();
        ranges();
    }

private:
    void nodes() const {
        for (Index& body : rows_of(model_.nodes.body, has_.nodes)) lower(body, shift_.bodies);
        for (Index& body : rows_of(model_.rigid_bodies.body, has_.rigid)) lower(body, shift_.bodies);
        for (Index& node : rows_of(model_.node_blocks.begin, has_.node_blocks)) lower(node, shift_.nodes);
        for (Index& node : rows_of(model_.node_blocks.end, has_.node_blocks)) lower(node, shift_.nodes);
        for (Index& body : rows_of(model_.node_blocks.body, has_.node_blocks)) lower(body, shift_.bodies);
    }

    void elements() const {
        for (TetrahedronNodes& corner : rows_of(model_.tetrahedra.node, has_.tetrahedron_blocks))
            for (NodeLane& lanes : corner)
                for (Index& node : lanes.lane) lower(node, shift_.nodes);
        for (NodeLane& lanes : rows_of(model_.element_nodes.node, has_.element_nodes))
            for (Index& node : lanes.lane) lower(node, shift_.nodes);
        for (Index& first : rows_of(model_.elements.first, has_.blocks)) lower(first, shift_.element_nodes);
        for (Index& body : rows_of(model_.elements.body, has_.blocks)) lower(body, shift_.bodies);
    }

    void surface() const {
        TriangleTable& triangles = model_.surface.triangles;
        EdgeTable& edges = model_.surface.edges;
        VertexTable& vertices = model_.surface.vertices;
        const auto lower_all = [](auto& column, Range range, Index by) {
            for (auto& items : rows_of(column, range))
                for (Index& item : items) lower(item, by);
        };
        lower_all(triangles.node, has_.triangles, shift_.nodes);
        lower_all(triangles.edge, has_.triangles, shift_.edges);
        lower_all(triangles.vertex, has_.triangles, shift_.vertices);
        constexpr auto in_block = static_cast<Index>(element_lanes);
        for (Index& t : rows_of(triangles.element, has_.triangles)) lower(t, shift_.tetrahedron_blocks * in_block);
        lower_all(edges.node, has_.edges, shift_.nodes);
        lower_all(edges.triangle, has_.edges, shift_.triangles);
        for (Index& node : rows_of(vertices.node, has_.vertices)) lower(node, shift_.nodes);
        for (Index& item : rows_of(vertices.triangle_begin, has_.vertices)) lower(item, shift_.vertex_triangles);
        for (Index& item : rows_of(vertices.triangle_end, has_.vertices)) lower(item, shift_.vertex_triangles);
        for (Index& t : rows_of(model_.surface.vertex_triangle, has_.vertex_triangles)) lower(t, shift_.triangles);
    }

    void tree() const {
        for (BvhNode& node : rows_of(model_.bvh.node, has_.bvh_nodes)) {
            lower(node.skip, shift_.bvh_nodes);
            lower(node.right, shift_.bvh_nodes);
            lower(node.leaf, shift_.bvh_leaves);
        }
        for (LeafTriangles& leaf : rows_of(model_.bvh_leaves.triangle, has_.bvh_leaves))
            for (Index& t : leaf) lower(t, shift_.triangles);
        for (LeafNodes& leaf : rows_of(model_.bvh_leaves.nodes, has_.bvh_leaves)) {
            for (auto& corner : leaf.corner)
                for (Index& node : corner) lower(node, shift_.nodes);
            for (Index i = 0; i < leaf.count; ++i) lower(leaf.node[static_cast<std::size_t>(i)], shift_.nodes);
        }
        for (LeafFeatures& features : rows_of(model_.bvh_leaves.features, has_.bvh_leaves)) {
            for (Index i = 0; i < features.edge_count; ++i) {
                LeafFeatures::Edge& edge = features.edge[static_cast<std::size_t>(i)];
                lower(edge.row, shift_.edges);
                for (Index& node : edge.node) lower(node, shift_.nodes);
            }
            for (Index i = 0; i < features.point_count; ++i) {
                LeafFeatures::Point& point = features.point[static_cast<std::size_t>(i)];
                lower(point.row, shift_.vertices);
                lower(point.node, shift_.nodes);
            }
        }
    }

    void ranges() const {
        BodyTable& table = model_.bodies;
        lower(table.nodes[body_], shift_.nodes);
        lower(table.node_blocks[body_], shift_.node_blocks);
        lower(table.blocks[body_], shift_.blocks);
        lower(table.element_nodes[body_], shift_.element_nodes);
        lower(table.tetrahedron_blocks[body_], shift_.tetrahedron_blocks);
        lower(table.triangles[body_], shift_.triangles);
        lower(table.edges[body_], shift_.edges);
        lower(table.vertices[body_], shift_.vertices);
        lower(table.bvh_nodes[body_], shift_.bvh_nodes);
        lower(table.bvh_leaves[body_], shift_.bvh_leaves);
        lower(table.rigid[body_], shift_.rigid);
        lower(table.implicit[body_], shift_.implicit);
    }

    Model& model_;
    std::size_t body_;
    OfBodyTables<Range> has_;
    OfBodyTables<Index> shift_;
};

/// Removes the records of removed table rows from a list that has one record for each row of the table.
template <class Record>
void erase_records(std::span<const Index> row_now, std::vector<Record>& records) {
    std::size_t row = 0;
    std::erase_if(records, [&](const Record&) { return row_now[row++] == no_index; });
}

/// Removes scripts together with their keyframes. A remaining script without keyframes has an empty range, which may
/// start at a removed keyframe; row_without() allows this.
void erase_scripts(std::span<const Range> removed, auto& table) {
    std::vector<Range> keys, merged;
    for (const Range& rows : removed)
        for (auto row = static_cast<std::size_t>(rows.begin); row < static_cast<std::size_t>(rows.end); ++row)
            keys.push_back({table.script[row].key_begin, table.script[row].key_end});
    std::ranges::sort(keys, {}, &Range::begin);
    for (const Range& of_script : keys) append_gone(of_script, merged);
    table.keyframe.erase(merged);
    AnyTable(table).erase(removed);
    for (MotionScript& script : table.script) {
        script.key_begin = row_without(script.key_begin, merged);
        script.key_end = row_without(script.key_end, merged);
    }
}

void erase_attachments(const RowMoves& moves, Model& model) {
    AttachmentTable& table = model.attachments;
    erase_scripted_rows(moves.removed_attachments, table);
    for (std::size_t a = 0; a < table.slot.size(); ++a) {
        const OfBodyTables<Index>& shift = moves.shift_to_start[static_cast<std::size_t>(table.body[a])];
        for (Index& node : rows_of(table.node, table.nodes[a])) lower(node, shift.nodes);
        lower(table.body[a], shift.bodies);
    }
    model.attachment_map.rows_moved(moves.attachment_now);
}

void erase_colliders(const RowMoves& moves, Model& model) {
    erase_scripted_rows(moves.removed_colliders, model.colliders);
    erase_records(moves.collider_now, model.collider_records);
    model.collider_map.rows_moved(moves.collider_now);
    for (Index& body : model.colliders.body)
        if (body != no_index) body = moves.body_now[static_cast<std::size_t>(body)];
    for (Index& collider : model.bodies.collider)
        if (collider != no_index) collider = moves.collider_now[static_cast<std::size_t>(collider)];
}

/// Renumbers the nodes and bodies of clusters (groups of nodes that implicit elements couple). No cluster belongs to a
/// removed body, because all clusters are cleared before a body with elements is removed, and found again later.
void renumber_clusters(const RowMoves& moves, const Model& model, NodeClusters& clusters) {
    if (clusters.empty()) return;
    for (Index& node : clusters.nodes.item)
        lower(node,
              moves.shift_to_start[static_cast<std::size_t>(model.nodes.body[static_cast<std::size_t>(node)])].nodes);
    for (Index& body : clusters.body) lower(body, moves.shift_to_start[static_cast<std::size_t>(body)].bodies);
    clusters.cluster_of.erase(moves.removed.nodes);
    clusters.index_in_cluster.erase(moves.removed.nodes);
}

void erase_bodies(const RowMoves& moves, Model& model) {
    const auto first = static_cast<std::size_t>(moves.removed.bodies.front().begin);
    for (std::size_t b = first; b < moves.body_now.size(); ++b)
        if (moves.body_now[b] == no_index && model.has_loads(b)) --model.loaded_bodies;
    truncate_patches(model.bodies.blocks[first].begin, model.bodies.nodes[first].begin, model.patches);
    renumber_clusters(moves, model, model.clusters);
    model.known_elements.clear();
    for (std::size_t b = first; b < moves.body_now.size(); ++b)
        if (moves.body_now[b] != no_index)
            renumber_rows_of_body(model, b, rows_of_body(model, b), moves.shift_to_start[b]);
    const OfBodyTables<std::vector<Range>>& removed = moves.removed;
    constexpr auto list_of = OfBodyTables<std::vector<Range>>::members();
    const std::vector<std::vector<AnyColumn>> tables = columns_by_body_table(model);
    for (std::size_t table = 0; table < tables.size(); ++table)
        for (const AnyColumn& column : tables[table]) column.erase(removed.*list_of[table]);
    for (auto rows = removed.rigid.rbegin(); rows != removed.rigid.rend(); ++rows)
        model.stiff_bodies.erase(model.stiff_bodies.begin() + rows->begin, model.stiff_bodies.begin() + rows->end);
    erase_records(moves.body_now, model.body_records);
    model.body_mass.erase(removed.bodies);
    model.watch.erase(removed.bodies, removed.nodes);
    model.body_map.rows_moved(moves.body_now);
}

}  // namespace

void renumber_rows_of_body(Model& model, std::size_t body, const OfBodyTables<Range>& rows,
                           const OfBodyTables<Index>& shift) {
    RowsOfBody(model, body, rows, shift).renumber();
}

void erase_scripted_rows(std::span<const Range> removed, ColliderTable& table) {
    erase_scripts(removed, table);
}

void erase_scripted_rows(std::span<const Range> removed, AttachmentTable& table) {
    std::vector<Range> nodes;
    for (const Range& rows : removed)
        for (auto row = static_cast<std::size_t>(rows.begin); row < static_cast<std::size_t>(rows.end); ++row)
            append_gone(table.nodes[row], nodes);
    table.node.erase(nodes);
    table.anchor.erase(nodes);
    erase_scripts(removed, table);
    Index end = 0;  // the node lists of the rows follow each other without gaps
    for (Range& of_row : table.nodes) {
        of_row = {end, end + of_row.size()};
        end = of_row.end;
    }
}

void erase_gone(const RowMoves& moves, Model& model) {
    if (!moves.removed.bodies.empty()) erase_attachments(moves, model);
    if (!moves.removed.bodies.empty()) erase_bodies(moves, model);
    if (!moves.removed.bodies.empty()) renumber_joining_rows(ColumnRole::body, moves.body_now, model);
    if (!moves.removed_colliders.empty()) renumber_joining_rows(ColumnRole::collider, moves.collider_now, model);
    if (!moves.removed_colliders.empty() || !moves.removed.bodies.empty()) erase_colliders(moves, model);
}

}  // namespace skerry
