// Functions that add bodies between steps. Each body has a range of rows in every table.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "components/any_table.h"
#include "engine/mesh/repair/surface_measures.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
#include "engine/world/step/step.h"
#include "systems/collision/build_surface.h"
#include "systems/dynamics/elements/build_elements.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

// Initial value of uninverted_until, the travel of the body up to which no tetrahedron can invert [m]. With this value
// find_inversions checks all tetrahedra in the next step.
constexpr Real not_evaluated = -infinity;

// default contact distance, divided by the mean edge length of the surface; small compared with the mesh resolution
constexpr Real default_contact_distance = 0.02;

Range appended(std::size_t before, std::size_t after) {
    return {static_cast<Index>(before), static_cast<Index>(after)};
}

Range append_nodes(Model& model, const NewBody& body, Index row) {
    NodeTable& nodes = model.nodes;
    const std::size_t begin = nodes.position.size(), end = begin + body.nodes.size();
    AnyTable(nodes).resize(end);
    for (std::size_t n = begin; n < end; ++n) {
        nodes.rest_position[n] = body.nodes[n - begin];
        nodes.position[n] = nodes.displacement_origin[n] = nodes.still_position[n] =
            body.position + body.rotation * body.nodes[n - begin];
        nodes.velocity[n] = nodes.velocity_next[n] = nodes.push_out[n] = nodes.force[n] = nodes.load[n] =
            nodes.applied_force[n] = nodes.applied_before[n] = Vec3::Zero();
        nodes.body[n] = row;
    }
    const auto nodes_end = static_cast<std::size_t>(step_nodes_of(appended(begin, end), body.core_nodes).end);
    for (std::size_t first = begin; first < nodes_end; first += nodes_per_block) {
        const std::size_t block = model.node_blocks.begin.size();
        AnyTable(model.node_blocks).resize(block + 1);
        model.node_blocks.begin[block] = static_cast<Index>(first);
        model.node_blocks.end[block] = static_cast<Index>(std::min<std::size_t>(first + nodes_per_block, nodes_end));
        model.node_blocks.body[block] = row;
    }
    return appended(begin, end);
}

/// Element kind that is recorded for a body; linear if it has no material zones. The kinds of zones differ only if the
/// requested kind `smoothed` became edge_smoothed in some and edge_node_smoothed in others. The result is then
/// edge_node_smoothed.
ElementKind kind_of(std::span<const MaterialZone> zones) {
    ElementKind kind = zones.empty() ? ElementKind::linear : zones.front().kind;
    for (const MaterialZone& zone : zones)
        if (zone.kind == ElementKind::edge_node_smoothed) kind = zone.kind;
    return kind;
}

/// Sets the node masses of a body, and its initial rigid motion about the centre of mass.
void set_masses_and_motion(Model& model, const NewBody& body, Range range) {
    NodeTable& nodes = model.nodes;
    if (body.kind == BodyKind::kinematic) return;  // the nodes of mesh colliders keep their inverse mass of 0
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

Range append_implicit_nodes(Model& model, Index count) {
    const std::size_t begin = model.implicit_nodes.size(), end = begin + static_cast<std::size_t>(count);
    AnyTable(model.implicit_nodes).resize(end);
    return appended(begin, end);
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

/// Smallest altitude of all tetrahedra of a body; 0 without tetrahedra [m].
Real smallest_altitude(const NewBody& body) {
    Real smallest = infinity;
    for (const auto& tetrahedron : body.tetrahedra)
        smallest = std::min(smallest, skerry::smallest_altitude(tetrahedron, body.nodes));
    return body.tetrahedra.empty() ? 0 : smallest;
}

/// Location of a new body in the tables. `places`: element in each SIMD lane of the element blocks. `covered`: for each
/// lane, the tetrahedra that its element covers.
struct RowsOfBody {
    Index row;
    Range nodes, tetrahedra;
    ElementPlaces places;
    AppendedElements elements;
    Ragged<Index> covered;
};

/// Builds the elements of a body and appends them to the tables. `known`: stored results for an earlier body with the
/// same mesh, or null.
void append_elements_of(Model& model, const NewBody& body, std::span<const MaterialZone> zones,
                        const KnownElements* known, RowsOfBody& rows) {
    // local, so that it is freed on return: it takes a third of the memory of all tables of the body
    ElementList list = elements_of({body.tetrahedra, body.nodes}, zones);
    add_guards({body.tetrahedra, body.nodes}, zones, list);
    rows.places = known ? known->places : find_places(list, rows_of(model.nodes.rest_position, rows.nodes));
    rows.elements = append_elements(list, rows.places, rows.nodes.begin, rows.row, model.elements, model.element_nodes);
    const Range blocks = rows.elements.blocks;
    start_mass_shares(model.all_elements(), blocks, rows_of(model.elements.mass_share, blocks));
    rows.covered = covered_tetrahedra(list, rows.elements.element);
}

/// Surface triangles of a body in local node numbers: the triangles given by the user, or the boundary of the
/// tetrahedra.
std::vector<std::array<Index, 3>> outline(const Model& model, std::size_t b, const NewBody& body) {
    std::vector<std::array<Index, 3>> triangles(body.triangles.begin(), body.triangles.end());
    if (body.core_nodes > 0) {
        // a round body has no rows in the surface tables
        for (const BoundaryTriangle& triangle : boundary_triangles(body.tetrahedra)) triangles.push_back(triangle.node);
    } else if (!body.tetrahedra.empty()) {
        for (const auto& [i, j, k] : rows_of(model.surface.triangles.node, model.bodies.triangles[b])) {
            const Index first = model.bodies.nodes[b].begin;
            triangles.push_back({i - first, j - first, k - first});
        }
    }
    return triangles;
}

}  // namespace

Ragged<Index> covered_tetrahedra(const ElementList& list, std::span<const Index> element_at) {
    Ragged<Index> covered;
    covered.offset.reserve(element_at.size() + 1);
    covered.item.reserve(list.tetrahedron.size());
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

Index append_body(Model& model, Column<Real>& stiffness_sum, const NewBody& body, const KnownElements* trial) {
    BodyTable& bodies = model.bodies;
    const std::size_t b = bodies.slot.size();
    const auto row = static_cast<Index>(b);
    AnyTable(bodies).resize(b + 1);

    const auto first_block = static_cast<Index>(model.node_blocks.begin.size());
    const Range nodes = append_nodes(model, body, row);
    stiffness_sum.resize(model.nodes.position.size());
    set_masses_and_motion(model, body, nodes);
    RowsOfBody rows{row, nodes, {}, {}, {}, {}};
    rows.tetrahedra = append_tetrahedra(body.tetrahedra, body.nodes, nodes.begin, model.tetrahedra);
    const std::vector<MaterialZone> all_zones = zones_of(model, body);
    // Rigid and implicit bodies have tetrahedra, but no rows in the element tables.
    const std::vector<MaterialZone> zones = body.has_frame() ? std::vector<MaterialZone>() : all_zones;
    // Elements are first built for the unrotated body. Data computed in this state can be copied from a body with the
    // same mesh. The elements are rotated at the end.
    const KnownElements* const known = trial && !body.has_frame() ? trial : known_elements(model, body);
    append_elements_of(model, body, zones, known, rows);
    const Range blocks = rows.elements.blocks;
    bodies.slot[b] = body.slot;
    bodies.kind[b] = body.kind;
    bodies.self_contact[b] = body.self_contact;
    bodies.material[b] = body.material;
    bodies.filter[b] = body.filter;
    bodies.core_nodes[b] = body.core_nodes;
    bodies.round_radius[b] = body.round_radius;
    bodies.collider[b] = body.collider;
    bodies.nodes[b] = nodes;
    bodies.node_blocks[b] = {first_block, static_cast<Index>(model.node_blocks.begin.size())};
    bodies.blocks[b] = blocks;
    bodies.element_nodes[b] = rows.elements.nodes;
    bodies.tetrahedron_blocks[b] = rows.tetrahedra;
    bodies.rigid[b] = {static_cast<Index>(model.rigid_bodies.size()), static_cast<Index>(model.rigid_bodies.size())};
    const bool implicit = body.dynamics == BodyDynamics::implicit_elastic;
    bodies.implicit[b] = append_implicit_nodes(model, implicit ? nodes.size() : 0);
    bodies.tetrahedron_count[b] = static_cast<Index>(body.tetrahedra.size());
    bodies.uninverted_until[b] = not_evaluated;
    std::ranges::fill(rows_of(model.tetrahedra.uninverted_until, rows.tetrahedra), not_evaluated);
    bodies.pinned_count[b] = body.kind == BodyKind::kinematic ? nodes.size() : 0;
    model.body_records.push_back(
        {.name = {},
         .element = kind_of(implicit ? all_zones : zones),
         .requested_element = body.element,
         .tetrahedra = {body.tetrahedra.begin(), body.tetrahedra.end()},
         .surface = {body.triangles.begin(), body.triangles.end()},
         .tetrahedron_material = {body.tetrahedron_material.begin(), body.tetrahedron_material.end()},
         .element_tetrahedra = std::move(rows.covered),
         .start = {body.position, body.rotation},
         .built = body.rotation,
         .mesh_shape = {body.mesh_shape.begin(), body.mesh_shape.end()},
         .given_mass = body.given_mass()});
    if (body.has_frame()) append_rigid_body(model, row, body);
    if (implicit) model.stiffen(b);
    model.settled = false;
    model.append_outline(b);
    model.body_records[b].surface = outline(model, b, body);
    // A round body has no rows of edges, because its triangles are used only for drawing. The mean edge is that of the
    // drawn mesh.
    bodies.mean_edge[b] = body.core_nodes > 0
                              ? mesh::mean_edge({{body.nodes.begin(), body.nodes.end()}, model.body_records[b].surface})
                              : mean_edge_length(model, bodies.edges[b]);
    bodies.contact_distance[b] =
        body.contact_distance >= 0 ? body.contact_distance : default_contact_distance * bodies.mean_edge[b];
    bodies.min_altitude[b] = smallest_altitude(body);
    if (known) {
        take_steps(*known, row, model);
    } else {
        find_steps(model, row, body, zones, stiffness_sum);
        remember_elements(model, row, body, std::move(rows.places));
    }
    turn_elements(body.rotation, blocks, model.elements, model.element_nodes);
    // The stable step is evaluated after the rotation of the elements. A later evaluation of the unmoved body then
    // gives a bitwise equal step.
    bodies.stable_step[b] =
        kernels().stable_step(model.all_elements(), blocks, model.nodes.position, model.nodes.mass, stiffness_sum).step;
    return row;
}

}  // namespace skerry
