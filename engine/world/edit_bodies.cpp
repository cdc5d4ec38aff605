// Bodies come and go between steps. A body is a range of rows in every table; rows behind a removed body move down.
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>

#include "engine/world/world_state.h"
#include "systems/collision/build_surface.h"
#include "systems/collision/tree/bvh.h"
#include "systems/dynamics/build_elements.h"
#include "systems/dynamics/element_levels.h"
#include "systems/dynamics/stable_step.h"

namespace skerry {

namespace {

constexpr Real default_contact_distance = 0.02;  // of the mean surface edge: thin against what the mesh can resolve

Range appended(std::size_t before, std::size_t after) {
    return {static_cast<Index>(before), static_cast<Index>(after)};
}

Range append_nodes(WorldState& world, const NewBody& body, Index row) {
    NodeTable& nodes = world.nodes;
    const std::size_t begin = nodes.position.size(), end = begin + body.nodes.size();
    nodes.for_each_column([end](const char*, auto& column) { column.resize(end); });
    for (std::size_t n = begin; n < end; ++n) {
        nodes.rest_position[n] = body.nodes[n - begin];
        nodes.position[n] = nodes.drift_origin[n] = body.position + body.rotation * body.nodes[n - begin];
        nodes.velocity[n] = nodes.velocity_next[n] = nodes.push_out[n] = nodes.force[n] = nodes.load[n] = Vec3::Zero();
        nodes.body[n] = row;
    }
    for (std::size_t first = begin; first < end; first += nodes_per_block) {
        const std::size_t block = world.node_blocks.begin.size();
        world.node_blocks.for_each_column([block](const char*, auto& column) { column.resize(block + 1); });
        world.node_blocks.begin[block] = static_cast<Index>(first);
        world.node_blocks.end[block] = static_cast<Index>(std::min<std::size_t>(first + nodes_per_block, end));
        world.node_blocks.body[block] = row;
    }
    return appended(begin, end);
}

/// Masses of the nodes, and the initial rigid motion about the centre of mass.
void set_masses_and_motion(WorldState& world, const NewBody& body, Range range) {
    NodeTable& nodes = world.nodes;
    if (body.kind == BodyKind::kinematic) return;  // no mass: inverse mass 0
    const auto first = static_cast<std::size_t>(range.begin), count = static_cast<std::size_t>(range.size());
    const Real density = world.materials.constants[static_cast<std::size_t>(body.material)].density;
    add_lumped_mass(body.tetrahedra, body.nodes, density, nodes.mass.span().subspan(first, count));
    Vec3 center = Vec3::Zero();
    Real mass = 0;
    for (std::size_t n = first; n < first + count; ++n) {
        nodes.inverse_mass[n] = nodes.mass[n] > 0 ? 1 / nodes.mass[n] : 0;
        center += nodes.mass[n] * nodes.position[n];
        mass += nodes.mass[n];
    }
    center /= mass;
    for (std::size_t n = first; n < first + count; ++n)
        nodes.velocity[n] = body.velocity + body.angular_velocity.cross(nodes.position[n] - center);
}

Real mean_edge_length(const WorldState& world, Range edges) {
    Real sum = 0;
    for (auto e = static_cast<std::size_t>(edges.begin); e < static_cast<std::size_t>(edges.end); ++e) {
        const auto [a, b] = world.surface.edges.node[e];
        sum += (world.nodes.rest_position[static_cast<std::size_t>(a)] - world.nodes.rest_position[static_cast<std::size_t>(b)]).norm();
    }
    return edges.size() > 0 ? sum / edges.size() : 0;
}

/// Smallest altitude of the tetrahedra: three times the volume over the largest face.
Real smallest_altitude(const NewBody& body) {
    Real smallest = std::numeric_limits<Real>::infinity();
    for (const auto& t : body.tetrahedra) {
        std::array<Vec3, 4> x;
        for (std::size_t a = 0; a < 4; ++a) x[a] = body.nodes[static_cast<std::size_t>(t[a])];
        const Real six_volumes = (x[1] - x[0]).dot((x[2] - x[0]).cross(x[3] - x[0]));
        for (std::size_t a = 0; a < 4; ++a) {
            const Vec3 &p = x[(a + 1) % 4], &q = x[(a + 2) % 4], &r = x[(a + 3) % 4];
            smallest = std::min(smallest, six_volumes / (q - p).cross(r - p).norm());
        }
    }
    return body.tetrahedra.empty() ? 0 : smallest;
}

std::array<Index, element_level_count> level_count_of(const ElementBlockTable& elements, Range blocks) {
    std::array<Index, element_level_count> count{};
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
        for (Real volume : elements.volume[b].lane) count[elements.level[b]] += volume > 0;
    return count;
}

/// Triangles name the elements that they belong to as these stand in the table.
void renumber_elements(std::span<const Index> order, std::span<BoundaryTriangle> triangles) {
    if (order.empty()) return;
    std::vector<Index> place(order.size());
    for (std::size_t e = 0; e < order.size(); ++e) place[static_cast<std::size_t>(order[e])] = static_cast<Index>(e);
    for (BoundaryTriangle& triangle : triangles) triangle.element = place[static_cast<std::size_t>(triangle.element)];
}

/// Takes rows `gone` out of every column of a table.
void erase_rows(auto& table, Range gone) {
    table.for_each_column(
        [gone](const char*, auto& column) { column.erase(static_cast<std::size_t>(gone.begin), static_cast<std::size_t>(gone.size())); });
}

/// Sorts the elements of a new body by level, so that blocks have one level; their order within a level stays. Returns which tetrahedron
/// element e is: order[e]; empty while they stand in the order of the mesh.
std::vector<Index> sort_by_level(WorldState& world, const NewBody& body, Range blocks, Index first_node, Index row) {
    std::vector<std::uint8_t> level(static_cast<std::size_t>(blocks.size()) * element_lanes);
    const ElementInputs elements = world.element_inputs();
    const Real step = stable_step(elements, blocks, world.nodes.position, world.nodes.mass, world.stiffness_sum).step;
    find_element_levels(elements, blocks, world.nodes.position, world.nodes.mass, step, world.stiffness_sum, level);
    level.resize(body.tetrahedra.size());
    if (std::all_of(level.begin(), level.end(), [](std::uint8_t l) { return l == 0; })) return {};

    std::vector<Index> order(level.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return level[static_cast<std::size_t>(a)] < level[static_cast<std::size_t>(b)]; });
    std::vector<std::array<Index, 4>> sorted;
    sorted.reserve(order.size());
    for (Index t : order) sorted.push_back(body.tetrahedra[static_cast<std::size_t>(t)]);
    erase_rows(world.elements, blocks);
    append_elements(sorted, body.nodes, first_node, row, body.material, body.rotation, world.elements);
    for (Index b = blocks.begin; b < blocks.end; ++b)  // the first lane has the lowest level
        world.elements.level[static_cast<std::size_t>(b)] =
            level[static_cast<std::size_t>(order[static_cast<std::size_t>(b - blocks.begin) * element_lanes])];
    const auto first = static_cast<std::size_t>(blocks.begin), count = static_cast<std::size_t>(blocks.size());
    find_viscous_times(world.elements.level.span().subspan(first, count), step, world.elements.viscous_time.span().subspan(first, count));
    return order;
}

std::vector<BoundaryTriangle> outline(const NewBody& body) {
    if (!body.tetrahedra.empty()) return boundary_triangles(body.tetrahedra);
    std::vector<BoundaryTriangle> triangles;
    triangles.reserve(body.triangles.size());
    for (const auto& triangle : body.triangles) triangles.push_back({triangle, no_index});
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
    Range nodes, node_blocks, blocks, triangles, edges, vertices, vertex_triangles, bvh_nodes, bvh_leaves, bodies;

    Range elements() const { return {blocks.begin * element_lanes, blocks.end * element_lanes}; }

    void apply(WorldState& world) const {
        for (Index& body : world.nodes.body) shift(body, bodies);
        for (Index& n : world.node_blocks.begin) shift(n, nodes);
        for (Index& n : world.node_blocks.end) shift(n, nodes);
        for (Index& body : world.node_blocks.body) shift(body, bodies);
        for (ElementNodes& corner : world.elements.node)
            for (auto& lanes : corner)
                for (Index& n : lanes.lane) shift(n, nodes);
        for (Index& body : world.elements.body) shift(body, bodies);
        surface(world.surface);
        for (BvhNode& node : world.bvh.node) {
            shift(node.skip, bvh_nodes);
            if (node.right != no_index) shift(node.right, bvh_nodes);
            if (node.leaf != no_index) shift(node.leaf, bvh_leaves);
        }
        for (LeafTriangles& leaf : world.bvh_leaves.triangle)
            for (Index& t : leaf)
                if (t != no_index) shift(t, triangles);
        ranges(world.bodies);
        for (Index& body : world.colliders.body)
            if (body != no_index) shift(body, bodies);
        for (Index& body : world.attachments.body) shift(body, bodies);
        for (Index& n : world.attachments.node) shift(n, nodes);
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
            if (element != no_index) shift(element, elements());
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
            shift(table.triangles[b], triangles);
            shift(table.edges[b], edges);
            shift(table.vertices[b], vertices);
            shift(table.bvh_nodes[b], bvh_nodes);
            shift(table.bvh_leaves[b], bvh_leaves);
        }
    }
};

}  // namespace

Index append_body(WorldState& world, const NewBody& body) {
    BodyTable& bodies = world.bodies;
    const std::size_t b = bodies.slot.size();
    const auto row = static_cast<Index>(b);
    bodies.for_each_column([b](const char*, auto& column) { column.resize(b + 1); });

    const Range nodes = append_nodes(world, body, row);
    set_masses_and_motion(world, body, nodes);
    Range blocks = appended(world.elements.node.size(), world.elements.node.size());
    if (!body.tetrahedra.empty())
        blocks = append_elements(body.tetrahedra, body.nodes, nodes.begin, row, body.material, body.rotation, world.elements);
    world.stiffness_sum.resize(world.nodes.position.size());
    std::vector<Index> order;
    if (world.settings.multirate && !body.tetrahedra.empty()) order = sort_by_level(world, body, blocks, nodes.begin, row);
    std::vector<BoundaryTriangle> triangles = outline(body);
    renumber_elements(order, triangles);
    const SurfaceRanges surface =
        append_surface(triangles, nodes.begin, body.tetrahedra.empty() ? no_index : blocks.begin * element_lanes, world.surface);

    bodies.slot[b] = body.slot;
    bodies.kind[b] = body.kind;
    bodies.self_contact[b] = body.self_contact;
    bodies.material[b] = body.material;
    bodies.collider[b] = body.collider;
    bodies.nodes[b] = nodes;
    bodies.node_blocks[b] = {static_cast<Index>(world.node_blocks.begin.size()) - (nodes.size() + nodes_per_block - 1) / nodes_per_block,
                             static_cast<Index>(world.node_blocks.begin.size())};
    bodies.blocks[b] = blocks;
    bodies.triangles[b] = surface.triangles;
    bodies.edges[b] = surface.edges;
    bodies.vertices[b] = surface.vertices;
    const BvhRanges tree = append_bvh(surface.triangles, world.surface.triangles.node, world.nodes.position, world.bvh, world.bvh_leaves);
    bodies.bvh_nodes[b] = tree.nodes;
    bodies.bvh_leaves[b] = tree.leaves;
    bodies.element_count[b] = static_cast<Index>(body.tetrahedra.size());
    bodies.pinned_count[b] = body.kind == BodyKind::kinematic ? nodes.size() : 0;
    bodies.level_count[b] = level_count_of(world.elements, blocks);
    bodies.mean_edge[b] = mean_edge_length(world, surface.edges);
    bodies.contact_distance[b] = body.contact_distance >= 0 ? body.contact_distance : default_contact_distance * bodies.mean_edge[b];
    bodies.min_altitude[b] = smallest_altitude(body);
    const StableStep step = stable_step(world.element_inputs(), blocks, world.nodes.position, world.nodes.mass, world.stiffness_sum);
    bodies.rest_step[b] = bodies.stable_step[b] = step.step;

    BodyRecord record;
    record.element_order = std::move(order);
    record.tetrahedra.assign(body.tetrahedra.begin(), body.tetrahedra.end());
    for (const BoundaryTriangle& triangle : triangles) record.surface.push_back(triangle.node);
    world.body_records.push_back(std::move(record));
    return row;
}

void erase_body(WorldState& world, Index row) {
    const auto b = static_cast<std::size_t>(row);
    for (std::size_t a = world.attachments.slot.size(); a-- > 0;)
        if (world.attachments.body[a] == row) {
            if (world.attachments.slot[a] != no_slot)
                world.attachment_map.erase(world.attachment_map.handle_of_slot(world.attachments.slot[a]));
            else
                world.attachment_map.row_erased(static_cast<Index>(a));
            erase_attachment(world, static_cast<Index>(a));
        }

    const BodyTable& bodies = world.bodies;
    Renumber renumber{
        bodies.nodes[b],     bodies.node_blocks[b], bodies.blocks[b], bodies.triangles[b], bodies.edges[b], bodies.vertices[b], {},
        bodies.bvh_nodes[b], bodies.bvh_leaves[b],  {row, row + 1}};
    if (renumber.vertices.size() > 0)
        renumber.vertex_triangles = {world.surface.vertices.triangle_begin[static_cast<std::size_t>(renumber.vertices.begin)],
                                     world.surface.vertices.triangle_end[static_cast<std::size_t>(renumber.vertices.end) - 1]};
    erase_rows(world.nodes, renumber.nodes);
    erase_rows(world.node_blocks, renumber.node_blocks);
    erase_rows(world.elements, renumber.blocks);
    erase_rows(world.surface.triangles, renumber.triangles);
    erase_rows(world.surface.edges, renumber.edges);
    erase_rows(world.surface.vertices, renumber.vertices);
    world.surface.vertex_triangle.erase(static_cast<std::size_t>(renumber.vertex_triangles.begin),
                                        static_cast<std::size_t>(renumber.vertex_triangles.size()));
    erase_rows(world.bvh, renumber.bvh_nodes);
    erase_rows(world.bvh_leaves, renumber.bvh_leaves);
    erase_rows(world.bodies, renumber.bodies);
    world.body_records.erase(world.body_records.begin() + row);
    renumber.apply(world);
}

}  // namespace skerry
