// Bodies come and go between steps. A body is a range of rows in every table; rows behind a removed body move down.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/world/edit/edit_model.h"
#include "engine/world/kernels.h"
#include "systems/collision/build_surface.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/stability/element_levels.h"
#include "systems/dynamics/stability/stable_step.h"

namespace skerry {

namespace {

constexpr Real default_contact_distance = 0.02;  // of the mean surface edge: thin against what the mesh can resolve

Range appended(std::size_t before, std::size_t after) {
    return {static_cast<Index>(before), static_cast<Index>(after)};
}

Range append_nodes(Model& model, const NewBody& body, Index row) {
    NodeTable& nodes = model.nodes;
    const std::size_t begin = nodes.position.size(), end = begin + body.nodes.size();
    nodes.for_each_column([end](const char*, auto& column, ColumnRole) { column.resize(end); });
    for (std::size_t n = begin; n < end; ++n) {
        nodes.rest_position[n] = body.nodes[n - begin];
        nodes.position[n] = nodes.displacement_origin[n] = nodes.still_position[n] =
            body.position + body.rotation * body.nodes[n - begin];
        nodes.velocity[n] = nodes.velocity_next[n] = nodes.push_out[n] = nodes.force[n] = nodes.load[n] = Vec3::Zero();
        nodes.body[n] = row;
    }
    for (std::size_t first = begin; first < end; first += nodes_per_block) {
        const std::size_t block = model.node_blocks.begin.size();
        model.node_blocks.for_each_column([block](const char*, auto& column, ColumnRole) { column.resize(block + 1); });
        model.node_blocks.begin[block] = static_cast<Index>(first);
        model.node_blocks.end[block] = static_cast<Index>(std::min<std::size_t>(first + nodes_per_block, end));
        model.node_blocks.body[block] = row;
    }
    return appended(begin, end);
}

/// What all zones have, or, where `smoothed` stands for both, the one with nodes.
ElementKind kind_of(const NewBody& body, std::span<const MaterialZone> zones) {
    ElementKind kind = zones.empty() ? body.element : zones.front().kind;
    for (const MaterialZone& zone : zones)
        if (zone.kind == ElementKind::edge_node_smoothed) kind = zone.kind;
    return kind;
}

/// Masses of the nodes, and the initial rigid motion about the centre of mass.
void set_masses_and_motion(Model& model, const NewBody& body, Range range) {
    NodeTable& nodes = model.nodes;
    if (body.kind == BodyKind::kinematic) return;  // no mass: inverse mass 0
    const auto first = static_cast<std::size_t>(range.begin), count = static_cast<std::size_t>(range.size());
    set_masses(model, body, range);
    Vec3 center = Vec3::Zero();
    Real mass = 0;
    for (std::size_t n = first; n < first + count; ++n) {
        center += nodes.mass[n] * nodes.position[n];
        mass += nodes.mass[n];
    }
    center /= mass;
    for (std::size_t n = first; n < first + count; ++n)
        nodes.velocity[n] = body.velocity + body.angular_velocity.cross(nodes.position[n] - center);
}

Real mean_edge_length(const Model& model, Range edges) {
    Real sum = 0;
    for (auto e = static_cast<std::size_t>(edges.begin); e < static_cast<std::size_t>(edges.end); ++e) {
        const auto [a, b] = model.surface.edges.node[e];
        sum += (model.nodes.rest_position[static_cast<std::size_t>(a)] -
                model.nodes.rest_position[static_cast<std::size_t>(b)])
                   .norm();
    }
    return edges.size() > 0 ? sum / edges.size() : 0;
}

/// Smallest altitude of the tetrahedra: three times the volume over the largest face.
/// m, of all tetrahedra; 0 without any.
Real smallest_altitude(const NewBody& body) {
    Real smallest = std::numeric_limits<Real>::infinity();
    for (const auto& tetrahedron : body.tetrahedra)
        smallest = std::min(smallest, skerry::smallest_altitude(tetrahedron, body.nodes));
    return body.tetrahedra.empty() ? 0 : smallest;
}

std::array<Index, element_level_count> level_count_of(const ElementBlockTable& elements, Range blocks) {
    std::array<Index, element_level_count> count{};
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
        for (Real volume : elements.volume[b].lane) count[elements.level[b]] += volume > 0;
    return count;
}

/// Takes rows `gone` out of every column of a table.
void erase_rows(auto& table, Range gone) {
    table.for_each_column([gone](const char*, auto& column, ColumnRole) {
        column.erase(static_cast<std::size_t>(gone.begin), static_cast<std::size_t>(gone.size()));
    });
}

/// A new body as the tables have it: rows, and which element of the list stands at each place of its blocks.
struct BodyRows {
    Index row;
    Range nodes, tetrahedra;
    AppendedElements elements;
};

/// Appends the elements of a body; `level` of each, or none: all 0.
AppendedElements append_elements_of(Model& model, const ElementList& list, std::span<const std::uint8_t> level,
                                    const BodyRows& rows) {
    AppendedElements appended = append_elements(list, rows_of(model.nodes.rest_position, rows.nodes), level,
                                                rows.nodes.begin, rows.row, model.elements, model.element_nodes);
    start_mass_shares(model.all_elements(), appended.blocks, rows_of(model.elements.mass_share, appended.blocks));
    return appended;
}

/// Elements by level, so that blocks have one level.
void sort_by_level(Model& model, const ElementList& list, std::span<Real> stiffness_sum, BodyRows& rows) {
    const Range blocks = rows.elements.blocks;
    std::vector<std::uint8_t> at_place(rows.elements.element.size()), level(list.size());
    const ElementInputs elements = model.all_elements();
    const Real step =
        kernels().stable_step(elements, blocks, model.nodes.position, model.nodes.mass, stiffness_sum).step;
    find_element_levels(elements, blocks, model.nodes.position, model.nodes.mass, step, stiffness_sum, at_place);
    for (std::size_t place = 0; place < at_place.size(); ++place)
        if (const Index e = rows.elements.element[place]; e != no_index)
            level[static_cast<std::size_t>(e)] = at_place[place];
    if (std::all_of(level.begin(), level.end(), [](std::uint8_t l) { return l == 0; })) return;

    erase_rows(model.element_nodes, rows.elements.nodes);
    erase_rows(model.elements, blocks);
    rows.elements = append_elements_of(model, list, level, rows);
    find_viscous_times(rows_of(model.elements.level, rows.elements.blocks), step,
                       rows_of(model.elements.viscous_time, rows.elements.blocks));
}

/// The tetrahedra that the element at each place covers.
Ragged<Index> covered_tetrahedra(const ElementList& list, std::span<const Index> element_at) {
    Ragged<Index> covered;
    covered.offset.push_back(0);
    for (const Index e : element_at) {
        if (e != no_index) {
            const auto at = static_cast<std::size_t>(e);
            for (std::size_t i = list.first_tetrahedron[at]; i < list.first_tetrahedron[at + 1]; ++i)
                covered.item.push_back(list.tetrahedron[i]);
        }
        covered.offset.push_back(static_cast<Index>(covered.item.size()));
    }
    return covered;
}

/// The triangles that the user gave, or the boundary of the tetrahedra; local nodes.
std::vector<std::array<Index, 3>> outline(const NewBody& body) {
    std::vector<std::array<Index, 3>> triangles(body.triangles.begin(), body.triangles.end());
    for (const BoundaryTriangle& triangle : boundary_triangles(body.tetrahedra)) triangles.push_back(triangle.node);
    return triangles;
}

void shift(Index& row, Range gone) {
    if (row >= gone.end) row -= gone.size();
}

void shift(Range& range, Range gone) {
    shift(range.begin, gone);
    shift(range.end, gone);
}

/// Renumbers everything that points behind the rows that one body had.
struct Renumber {
    Range nodes, node_blocks, blocks, element_nodes, tetrahedron_blocks, triangles, edges, vertices, vertex_triangles,
        bvh_nodes, bvh_leaves, bodies;

    Range tetrahedra() const {
        return {tetrahedron_blocks.begin * element_lanes, tetrahedron_blocks.end * element_lanes};
    }

    void apply(Model& model) const {
        for (Index& body : model.nodes.body) shift(body, bodies);
        for (Index& n : model.node_blocks.begin) shift(n, nodes);
        for (Index& n : model.node_blocks.end) shift(n, nodes);
        for (Index& body : model.node_blocks.body) shift(body, bodies);
        for (TetrahedronNodes& corner : model.tetrahedra.node)
            for (NodeLane& lanes : corner)
                for (Index& n : lanes.lane) shift(n, nodes);
        for (NodeLane& lanes : model.element_nodes.node)
            for (Index& n : lanes.lane) shift(n, nodes);
        for (Index& first : model.elements.first) shift(first, element_nodes);
        for (Index& body : model.elements.body) shift(body, bodies);
        surface(model.surface);
        for (BvhNode& node : model.bvh.node) {
            shift(node.skip, bvh_nodes);
            if (node.right != no_index) shift(node.right, bvh_nodes);
            if (node.leaf != no_index) shift(node.leaf, bvh_leaves);
        }
        for (LeafTriangles& leaf : model.bvh_leaves.triangle)
            for (Index& t : leaf)
                if (t != no_index) shift(t, triangles);
        ranges(model.bodies);
        for (Index& body : model.colliders.body)
            if (body != no_index) shift(body, bodies);
        for (Index& body : model.attachments.body) shift(body, bodies);
        for (Index& n : model.attachments.node) shift(n, nodes);
    }

private:
    void surface(SurfaceTables& tables) const {
        for (auto& corner : tables.triangles.node)
            for (Index& n : corner) shift(n, nodes);
        for (auto& edge : tables.triangles.edge)
            for (Index& e : edge) shift(e, edges);
        for (auto& vertex : tables.triangles.vertex)
            for (Index& v : vertex) shift(v, vertices);
        for (Index& element : tables.triangles.element)
            if (element != no_index) shift(element, tetrahedra());
        for (auto& corner : tables.edges.node)
            for (Index& n : corner) shift(n, nodes);
        for (auto& side : tables.edges.triangle)
            for (Index& t : side)
                if (t != no_index) shift(t, triangles);
        for (Index& n : tables.vertices.node) shift(n, nodes);
        for (Index& item : tables.vertices.triangle_begin) shift(item, vertex_triangles);
        for (Index& item : tables.vertices.triangle_end) shift(item, vertex_triangles);
        for (Index& t : tables.vertex_triangle) shift(t, triangles);
    }

    void ranges(BodyTable& table) const {
        for (std::size_t b = 0; b < table.slot.size(); ++b) {
            shift(table.nodes[b], nodes);
            shift(table.node_blocks[b], node_blocks);
            shift(table.blocks[b], blocks);
            shift(table.element_nodes[b], element_nodes);
            shift(table.tetrahedron_blocks[b], tetrahedron_blocks);
            shift(table.triangles[b], triangles);
            shift(table.edges[b], edges);
            shift(table.vertices[b], vertices);
            shift(table.bvh_nodes[b], bvh_nodes);
            shift(table.bvh_leaves[b], bvh_leaves);
        }
    }
};

}  // namespace

Index append_body(Model& model, Column<Real>& stiffness_sum, const NewBody& body) {
    BodyTable& bodies = model.bodies;
    const std::size_t b = bodies.slot.size();
    const auto row = static_cast<Index>(b);
    bodies.for_each_column([b](const char*, auto& column, ColumnRole) { column.resize(b + 1); });

    const Range nodes = append_nodes(model, body, row);
    stiffness_sum.resize(model.nodes.position.size());
    set_masses_and_motion(model, body, nodes);
    BodyRows rows{row, nodes, {}, {}};
    rows.tetrahedra = append_tetrahedra(body.tetrahedra, body.nodes, nodes.begin, model.tetrahedra);
    const std::vector<MaterialZone> zones = zones_of(model, body);
    const ElementList list = elements_of({body.tetrahedra, body.nodes, body.rotation}, zones);
    rows.elements = append_elements_of(model, list, {}, rows);
    if (model.settings.multirate && !body.tetrahedra.empty()) sort_by_level(model, list, stiffness_sum, rows);
    const Range blocks = rows.elements.blocks;
    bodies.slot[b] = body.slot;
    bodies.kind[b] = body.kind;
    bodies.self_contact[b] = body.self_contact;
    bodies.material[b] = body.material;
    bodies.filter[b] = body.filter;
    bodies.collider[b] = body.collider;
    bodies.nodes[b] = nodes;
    bodies.node_blocks[b] = {
        static_cast<Index>(model.node_blocks.begin.size()) - (nodes.size() + nodes_per_block - 1) / nodes_per_block,
        static_cast<Index>(model.node_blocks.begin.size())};
    bodies.blocks[b] = blocks;
    bodies.element_nodes[b] = rows.elements.nodes;
    bodies.tetrahedron_blocks[b] = rows.tetrahedra;
    bodies.tetrahedron_count[b] = static_cast<Index>(body.tetrahedra.size());
    bodies.pinned_count[b] = body.kind == BodyKind::kinematic ? nodes.size() : 0;
    bodies.level_count[b] = level_count_of(model.elements, blocks);
    model.body_records.push_back({.name = {},
                                  .element = kind_of(body, zones),
                                  .tetrahedra = {body.tetrahedra.begin(), body.tetrahedra.end()},
                                  .surface = outline(body),
                                  .element_tetrahedra = covered_tetrahedra(list, rows.elements.element)});
    model.settled = false;
    model.append_outline(b);
    bodies.mean_edge[b] = mean_edge_length(model, bodies.edges[b]);
    bodies.contact_distance[b] =
        body.contact_distance >= 0 ? body.contact_distance : default_contact_distance * bodies.mean_edge[b];
    bodies.min_altitude[b] = smallest_altitude(body);
    find_steps(model, row, body, zones, model.nodes.position, stiffness_sum);
    return row;
}

void erase_body(Model& model, Index row) {
    const auto b = static_cast<std::size_t>(row);
    for (std::size_t a = model.attachments.slot.size(); a-- > 0;)
        if (model.attachments.body[a] == row) {
            if (model.attachments.slot[a] != no_slot)
                model.attachment_map.erase(model.attachment_map.handle_of_slot(model.attachments.slot[a]));
            else
                model.attachment_map.row_erased(static_cast<Index>(a));
            erase_attachment(model, static_cast<Index>(a));
        }

    const BodyTable& bodies = model.bodies;
    Renumber renumber{bodies.nodes[b],         bodies.node_blocks[b],        bodies.blocks[b],
                      bodies.element_nodes[b], bodies.tetrahedron_blocks[b], bodies.triangles[b],
                      bodies.edges[b],         bodies.vertices[b],           {},
                      bodies.bvh_nodes[b],     bodies.bvh_leaves[b],         {row, row + 1}};
    if (renumber.vertices.size() > 0)
        renumber.vertex_triangles = {
            model.surface.vertices.triangle_begin[static_cast<std::size_t>(renumber.vertices.begin)],
            model.surface.vertices.triangle_end[static_cast<std::size_t>(renumber.vertices.end) - 1]};
    erase_rows(model.nodes, renumber.nodes);
    erase_rows(model.node_blocks, renumber.node_blocks);
    erase_rows(model.tetrahedra, renumber.tetrahedron_blocks);
    erase_rows(model.elements, renumber.blocks);
    erase_rows(model.element_nodes, renumber.element_nodes);
    erase_rows(model.surface.triangles, renumber.triangles);
    erase_rows(model.surface.edges, renumber.edges);
    erase_rows(model.surface.vertices, renumber.vertices);
    model.surface.vertex_triangle.erase(static_cast<std::size_t>(renumber.vertex_triangles.begin),
                                        static_cast<std::size_t>(renumber.vertex_triangles.size()));
    erase_rows(model.bvh, renumber.bvh_nodes);
    erase_rows(model.bvh_leaves, renumber.bvh_leaves);
    erase_rows(model.bodies, renumber.bodies);
    model.body_records.erase(model.body_records.begin() + row);
    model.watch.erase(row, renumber.nodes);
    renumber.apply(model);
}

}  // namespace skerry
