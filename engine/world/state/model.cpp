#include "engine/world/state/model.h"

#include <algorithm>
#include <utility>

#include "engine/base/complaint.h"
#include "systems/collision/build_surface.h"
#include "systems/collision/tree/bvh.h"
#include "systems/dynamics/clusters/build_clusters.h"
#include "systems/dynamics/elements/build_elements.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_stale(const char* call, const char* kind) {
    refuse(call, kind, "a handle without an object", "a handle to an existing object of this world",
           "the object was removed, or belongs to another world");
}

template <class Map, class HandleType>
Index live_row(const Map& map, HandleType handle, const char* call, const char* kind) {
    const Index row = map.row(handle);
    if (row == no_index) refuse_stale(call, kind);
    return row;
}

ClusterInputs inputs_of_clusters(const Model& model) {
    return {model.bodies.blocks.span(), model.bodies.cluster_step.span(), model.elements.implicit_modulus.span(),
            model.nodes.mass.span(), model.nodes.inverse_mass.span()};
}

}  // namespace

std::vector<AnyTable> Model::tables() {
    std::vector<AnyTable> all;
    for_each_table([&](const char* name, auto& table) { all.emplace_back(table, name); });
    return all;
}

void Model::set_world(std::uint32_t number) {
    material_map.set_world(number);
    body_map.set_world(number);
    collider_map.set_world(number);
    attachment_map.set_world(number);
    for_each_joining([&](const char*, auto&, auto& map) { map.set_world(number); });
}

Index Model::row(BodyHandle body, const char* call) const {
    return live_row(body_map, body, call, "body");
}
Index Model::row(ColliderHandle collider, const char* call) const {
    return live_row(collider_map, collider, call, "collider");
}
Index Model::row(MaterialHandle material, const char* call) const {
    return live_row(material_map, material, call, "material");
}
Index Model::row(AttachmentHandle attachment, const char* call) const {
    return live_row(attachment_map, attachment, call, "attachment");
}
Index Model::row(SurfaceSetHandle set, const char* call) const {
    return live_row(surface_set_map, set, call, "surface set");
}
Index Model::row(JointHandle joint, const char* call) const {
    return live_row(joint_map, joint, call, "joint");
}
Index Model::row(TieHandle tie, const char* call) const {
    return live_row(tie_map, tie, call, "tie");
}
Index Model::row(CableHandle cable, const char* call) const {
    return live_row(cable_map, cable, call, "cable");
}
Index Model::row(CavityHandle cavity, const char* call) const {
    return live_row(cavity_map, cavity, call, "cavity");
}
Index Model::row(PipeHandle pipe, const char* call) const {
    return live_row(pipe_map, pipe, call, "pipe");
}
Index Model::row(FibreHandle family, const char* call) const {
    return live_row(fibre_map, family, call, "fibres");
}
Index Model::row(LoadHandle load, const char* call) const {
    return live_row(load_map, load, call, "load");
}
Index Model::row(SpringHandle spring, const char* call) const {
    return live_row(spring_map, spring, call, "spring");
}

ElementInputs Model::all_elements() const {
    return ElementInputs::bind({}, elements, element_nodes, materials);
}

ElementInputs Model::awake_elements() const {
    return ElementInputs::bind({}, elements, element_nodes, materials, bodies, any_idle);
}

bool Model::yields(std::size_t body) const {
    return std::ranges::any_of(rows_of(elements.material, bodies.blocks[body]), [&](Index material) {
        return materials.constants[static_cast<std::size_t>(material)].yields();
    });
}

std::optional<Model::RoundShape> Model::round_shape(std::size_t body) const {
    const Index core = bodies.core_nodes[body];
    if (core == 0) return std::nullopt;
    const Real radius = bodies.round_radius[body];
    const auto first = static_cast<std::size_t>(bodies.nodes[body].begin);
    const Vec3 middle =
        core == 2 ? Vec3((nodes.position[first] + nodes.position[first + 1]) / 2) : nodes.position[first];
    if (core == 1)
        return RoundShape{{ColliderShape::sphere, {radius, 0, 0}},
                          {middle, Mat3::Identity(), Vec3::Zero(), Vec3::Zero()}};
    const auto r = static_cast<std::size_t>(bodies.rigid[body].begin);
    const RigidMotion place{middle, rigid_bodies.rotation[r] * rigid_bodies.axes[r].transpose(), Vec3::Zero(),
                            Vec3::Zero()};
    const Real length = (nodes.rest_position[first + 1] - nodes.rest_position[first]).norm();
    if (core == cylinder_core_nodes) {
        const Real of_rim = (nodes.rest_position[first + 2] - nodes.rest_position[first + 1]).norm();
        return RoundShape{{ColliderShape::cylinder, {of_rim, length, 0}}, place};
    }
    return RoundShape{{ColliderShape::capsule, {radius, length / 2, 0}}, place};
}

bool Model::shares_mass(std::size_t body) const {
    const BodyRecord& record = body_records[body];
    return is_rigid(body) && (record.tetrahedra.empty() || record.given_mass != GivenMass::none);
}

Real Model::weight_of_node(std::size_t node) const {
    const auto body = static_cast<std::size_t>(nodes.body[node]);
    if (!shares_mass(body)) return nodes.mass[node];
    const auto r = static_cast<std::size_t>(bodies.rigid[body].begin);
    return rigid_bodies.mass[r] / static_cast<Real>(bodies.nodes[body].size());
}

Real Model::free_inverse_mass(std::size_t node) const {
    const Real mass = weight_of_node(node);
    return mass > 0 ? 1 / mass : 0;
}

const char* Model::round_name(std::size_t body) const {
    const Index core = bodies.core_nodes[body];
    return core == 1 ? "sphere" : core == 2 ? "capsule" : "cylinder";
}

Index Model::user_tetrahedron(std::size_t body, Index lane) const {
    return lane - static_cast<Index>(element_lanes) * bodies.tetrahedron_blocks[body].begin;
}

void Model::wake(std::size_t body) {
    bodies.asleep[body] = 0;
    bodies.still_time[body] = 0;
}

void Model::wake_all() {
    for (std::size_t b = 0; b < bodies.asleep.size(); ++b) wake(b);
}

Real Model::note_rest() {
    any_asleep = any_idle = false;
    Real awake_mass = 0;
    bodies.idle.resize(bodies.asleep.size());
    for (std::size_t b = 0; b < bodies.asleep.size(); ++b) {
        bodies.idle[b] = bodies.asleep[b] != 0 || bodies.is_led(b);
        any_asleep |= bodies.asleep[b] != 0;
        any_idle |= bodies.idle[b] != 0;
        if (!bodies.asleep[b] && !bodies.is_ghost(b)) awake_mass += body_mass[b];
    }
    return awake_mass;
}

bool Model::has_loads(std::size_t body) const {
    for (Index n = bodies.nodes[body].begin; n < bodies.nodes[body].end; ++n)
        if (nodes.load[static_cast<std::size_t>(n)] != Vec3::Zero()) return true;
    return false;
}

void Model::note_loads(std::size_t body, bool before) {
    loaded_bodies += static_cast<Index>(has_loads(body)) - static_cast<Index>(before);
}

ElementList Model::elements_of_implicit(std::size_t body) const {
    const BodyRecord& record = body_records[body];
    std::vector<MaterialZone> zones;
    for (std::size_t t = 0; t < record.tetrahedra.size(); ++t) {
        const Index material =
            record.tetrahedron_material.empty() ? bodies.material[body] : record.tetrahedron_material[t];
        auto zone = std::ranges::find(zones, material, &MaterialZone::material);
        if (zone == zones.end()) zone = zones.insert(zones.end(), {material, record.element, {}});
        zone->tetrahedra.push_back(static_cast<Index>(t));
    }
    return elements_of({record.tetrahedra, rows_of(nodes.rest_position, bodies.nodes[body])}, zones);
}

void Model::stiffen(std::size_t body) {
    const Range of_body = bodies.nodes[body];
    StiffBody& stiff = stiff_bodies[static_cast<std::size_t>(bodies.rigid[body].begin)];
    const BodyRecord& record = body_records[body];
    const std::span<const Vec3> rest = rows_of(nodes.rest_position, of_body);
    std::vector<Real> mass;
    for (std::size_t t = 0; t < record.tetrahedra.size(); ++t) {
        const Index material =
            record.tetrahedron_material.empty() ? bodies.material[body] : record.tetrahedron_material[t];
        mass.push_back(materials.constants[static_cast<std::size_t>(material)].density *
                       six_volumes(record.tetrahedra[t], rest) / 6);
    }
    stiff = StiffBody(elements_of_implicit(body), materials.constants, rows_of(nodes.mass, of_body), rest,
                      record.tetrahedra, mass);
    stiff.hold(rows_of(nodes.inverse_mass, of_body));
}

void Model::extend_derived() {
    const std::size_t first_body = body_mass.size();
    build_patches(elements, nodes.position.size(), element_nodes, patches);
    body_mass.resize(bodies.slot.size());
    bodies.idle.resize(bodies.slot.size());
    watch.first_piece.clear();
    for (std::size_t b = first_body; b < bodies.slot.size(); ++b) {
        body_mass[b] = 0;
        for (const Real mass : rows_of(nodes.mass, bodies.nodes[b])) body_mass[b] += mass;
    }
    if (!watch.step.empty()) {  // this column is empty before the first step
        watch.position.resize(nodes.position.size(), Vec3::Zero());
        watch.stiffness_sum.resize(nodes.position.size());
        watch.step.resize(bodies.slot.size(), StepWatch::not_evaluated);
    }
    if (!clusters.empty()) {
        clusters.cluster_of.resize(nodes.position.size(), no_index);
        clusters.index_in_cluster.resize(nodes.position.size(), no_index);
    }
}

void Model::derive_all() {
    patches = {};
    body_mass.clear();
    extend_derived();
    stiff_bodies.assign(rigid_bodies.size(), {});
    for (std::size_t b = 0; b < bodies.slot.size(); ++b)
        if (bodies.implicit[b].size() > 0) stiffen(b);
    loaded_bodies = 0;
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) note_loads(b, false);
    // Steps do not write velocity_next of sleeping nodes, nor push_out of nodes that no contact pushes. Both values
    // must be zero for these nodes.
    std::ranges::fill(nodes.velocity_next, Vec3::Zero());
    std::ranges::fill(nodes.push_out, Vec3::Zero());
}

void Model::rebuild_clusters() {
    build_clusters(all_elements(), inputs_of_clusters(*this), clusters);
}

void Model::rebuild_clusters(std::span<const std::uint8_t> body_changed) {
    skerry::rebuild_clusters(all_elements(), inputs_of_clusters(*this), body_changed, clusters);
}

bool Model::has_mesh(std::size_t body, const RestMesh& mesh) const {
    return std::ranges::equal(body_records[body].tetrahedra, mesh.tetrahedra) &&
           std::ranges::equal(rows_of(nodes.rest_position, bodies.nodes[body]), mesh.position);
}

Index Model::body_of_mesh(std::size_t end, const RestMesh& mesh) const {
    constexpr std::size_t most_looked_at = 16;
    if (mesh.tetrahedra.empty()) return no_index;
    for (std::size_t b = end; b > 0 && b + most_looked_at > end; --b)
        if (bodies.core_nodes[b - 1] == 0 && has_mesh(b - 1, mesh)) return static_cast<Index>(b - 1);
    return no_index;
}

void Model::append_outline(std::size_t body) {
    const BodyRecord& record = body_records[body];
    const Index core = bodies.core_nodes[body];
    const bool has_tetrahedra = core == 0 && !record.tetrahedra.empty();
    if (has_tetrahedra && append_outline_again(body)) return;
    std::vector<BoundaryTriangle> triangles;
    if (core > 0) {
        const Index end = core == 2 ? 1 : 0;
        triangles.push_back({{0, end, end}, no_index});
    } else if (has_tetrahedra) {
        triangles = boundary_triangles(record.tetrahedra);
    } else {
        for (const auto& triangle : record.surface) triangles.push_back({triangle, no_index});
    }
    const Index first_tetrahedron = has_tetrahedra ? bodies.tetrahedron_blocks[body].begin * element_lanes : no_index;
    const SurfaceRanges ranges = append_surface(triangles, bodies.nodes[body].begin, first_tetrahedron, surface);
    bodies.triangles[body] = ranges.triangles;
    bodies.edges[body] = ranges.edges;
    bodies.vertices[body] = ranges.vertices;
    const BvhRanges tree = append_bvh(ranges.triangles, surface.triangles.node, nodes.rest_position, bvh, bvh_leaves);
    append_leaf_features(tree.leaves, surface.triangles, bvh_leaves);
    bodies.bvh_nodes[body] = tree.nodes;
    bodies.bvh_leaves[body] = tree.leaves;
}

bool Model::append_outline_again(std::size_t body) {
    const Index found = body_of_mesh(
        body, {body_records[body].tetrahedra, rows_of(std::as_const(nodes).rest_position, bodies.nodes[body])});
    if (found == no_index) return false;
    const auto like = static_cast<std::size_t>(found);
    const auto blocks_behind = bodies.tetrahedron_blocks[body].begin - bodies.tetrahedron_blocks[like].begin;
    RowOffsets offset{bodies.nodes[body].begin - bodies.nodes[like].begin, blocks_behind * element_lanes};
    const SurfaceRanges ranges =
        append_surface_copy({bodies.triangles[like], bodies.edges[like], bodies.vertices[like]}, offset, surface);
    bodies.triangles[body] = ranges.triangles;
    bodies.edges[body] = ranges.edges;
    bodies.vertices[body] = ranges.vertices;
    const BvhRanges tree = append_bvh_copy({bodies.bvh_nodes[like], bodies.bvh_leaves[like]}, offset,
                                           nodes.rest_position, bvh, bvh_leaves);
    bodies.bvh_nodes[body] = tree.nodes;
    bodies.bvh_leaves[body] = tree.leaves;
    return true;
}

void Model::rebuild_outlines() {
    surface = {};
    bvh = {};
    bvh_leaves = {};
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) append_outline(b);
}

}  // namespace skerry
