#include "engine/world/save/saved_rows.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "components/hash.h"
#include "engine/mesh/require_positive.h"
#include "engine/world/save/checks.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

/// All data in which two meshes may differ. A mesh that equals an earlier one in all these data is not stored again.
struct MeshParts {
    std::span<const Vec3> nodes;
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> surface;
    std::span<const Index> covered_offset, covered_item;

    std::uint64_t hash() const {
        Hash hash;
        hash.add(nodes);
        hash.add(tetrahedra);
        hash.add(surface);
        hash.add(covered_offset);
        hash.add(covered_item);
        return hash.value();
    }
    bool operator==(const MeshParts& other) const {
        return std::ranges::equal(nodes, other.nodes) && std::ranges::equal(tetrahedra, other.tetrahedra) &&
               std::ranges::equal(surface, other.surface) && std::ranges::equal(covered_offset, other.covered_offset) &&
               std::ranges::equal(covered_item, other.covered_item);
    }
};

MeshParts parts_of(const SavedMeshes& meshes, std::size_t mesh) {
    return {meshes.nodes[mesh], meshes.tetrahedra[mesh], meshes.surface[mesh], meshes.covered_offset[mesh],
            meshes.covered_item[mesh]};
}

SavedMeshes meshes_of(const Model& model) {
    SavedMeshes meshes;
    std::multimap<std::uint64_t, Index> known;
    for (std::size_t b = 0; b < model.body_records.size(); ++b) {
        const BodyRecord& record = model.body_records[b];
        const Range nodes = model.bodies.nodes[b];
        const MeshParts parts{model.nodes.rest_position.span().subspan(static_cast<std::size_t>(nodes.begin),
                                                                       static_cast<std::size_t>(nodes.size())),
                              record.tetrahedra, record.surface, record.element_tetrahedra.offset.span(),
                              record.element_tetrahedra.item.span()};
        const std::uint64_t hash = parts.hash();
        const auto [begin, end] = known.equal_range(hash);
        const auto same = std::find_if(begin, end, [&](const auto& entry) {
            return parts_of(meshes, static_cast<std::size_t>(entry.second)) == parts;
        });
        if (same != end) {
            meshes.of_body.push_back(same->second);
            continue;
        }
        const auto mesh = static_cast<Index>(meshes.nodes.size());
        append(parts.nodes, meshes.nodes);
        append(parts.tetrahedra, meshes.tetrahedra);
        append(parts.surface, meshes.surface);
        append(parts.covered_offset, meshes.covered_offset);
        append(parts.covered_item, meshes.covered_item);
        known.emplace(hash, mesh);
        meshes.of_body.push_back(mesh);
    }
    return meshes;
}

struct SizeOf {
    using Size = std::array<Real, 6>;
    Size operator()(const Plane& p) const {
        return {p.normal.x(), p.normal.y(), p.normal.z(), p.point.x(), p.point.y(), p.point.z()};
    }
    Size operator()(const Sphere& s) const { return {s.radius}; }
    Size operator()(const Box& b) const { return {b.size.x(), b.size.y(), b.size.z()}; }
    Size operator()(const Capsule& c) const { return {c.radius, c.length}; }
    Size operator()(const Cylinder& c) const { return {c.radius, c.height}; }
    Size operator()(const Bucket& b) const { return {b.radius, b.height, b.thickness}; }
    Size operator()(const SurfaceMesh&) const { return {}; }
};

static_assert(std::variant_size_v<Shape> == static_cast<std::size_t>(ColliderShape::mesh) + 1);

/// Makes a shape from its kind and its saved members `s`. `mesh`: the mesh of a mesh collider; not used for other
/// shapes.
Shape shape_of(ColliderShape kind, const std::array<Real, 6>& s, const SurfaceMesh& mesh) {
    switch (kind) {
        case ColliderShape::plane:
            return Plane{{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
        case ColliderShape::sphere:
            return Sphere{s[0]};
        case ColliderShape::box:
            return Box{{s[0], s[1], s[2]}};
        case ColliderShape::capsule:
            return Capsule{s[0], s[1]};
        case ColliderShape::cylinder:
            return Cylinder{s[0], s[1]};
        case ColliderShape::bucket:
            return Bucket{s[0], s[1], s[2]};
        case ColliderShape::mesh:
            break;
    }
    return mesh;
}

/// Checks that a saved mesh satisfies the rules for meshes that users add to a world.
void check_mesh(const SavedMeshes& meshes, std::size_t m, const SavedFile& file) {
    const std::string path = "meshes/nodes";
    const MeshParts parts = parts_of(meshes, m);
    const auto count = static_cast<Index>(parts.nodes.size());
    const auto expect_corners = [&](const char* field, const auto& items) {
        for (const auto& item : items)
            for (const Index n : item)
                if (n < 0 || n >= count)
                    file.complain(std::string("meshes/") + field,
                                  "node " + std::to_string(n) + " of mesh " + std::to_string(m),
                                  "a node index below " + std::to_string(count));
    };
    expect_corners("tetrahedra", parts.tetrahedra);
    expect_corners("surface", parts.surface);
    try {
        if (!parts.tetrahedra.empty())
            validate({.nodes = {parts.nodes.begin(), parts.nodes.end()},
                      .tetrahedra = {parts.tetrahedra.begin(), parts.tetrahedra.end()}},
                     BodySettings{}, false);
        else
            validate(
                SurfaceMesh{{parts.nodes.begin(), parts.nodes.end()}, {parts.surface.begin(), parts.surface.end()}},
                ColliderSettings{});
    } catch (const SceneError& error) {
        file.complain(path, "mesh " + std::to_string(m) + " (" + error.what() + ")", "a valid mesh");
    }
}

/// Checks the lists of tetrahedra that the elements of a body cover. `places`: number of lists, one for each SIMD lane
/// of the element blocks of the body.
void check_cover(const MeshParts& parts, std::size_t places, const std::string& body, const SavedFile& file) {
    const std::span<const Index> offset = parts.covered_offset;
    if (offset.size() != places + 1)
        file.complain("meshes/covered_offset", std::to_string(offset.size()) + " offsets of " + body,
                      std::to_string(places + 1) + ", one more than the elements of the body");
    expect_all_offsets(file, "meshes/covered_offset", offset, parts.covered_item.size(), " of " + body);
    for (const Index t : parts.covered_item)
        if (t < 0 || t >= static_cast<Index>(parts.tetrahedra.size()))
            file.complain("meshes/covered_item", "tetrahedron " + std::to_string(t) + " of " + body,
                          "a tetrahedron index below " + std::to_string(parts.tetrahedra.size()));
}

/// Makes a handle from its saved slot and generation. A null handle gets no world number.
template <class HandleType>
HandleType handle_of(std::uint32_t slot, std::uint32_t generation, std::uint32_t world) {
    return slot == HandleType{}.slot ? HandleType{} : HandleType{slot, generation, world};
}

std::array<Real, 12> numbers_of(const RigidPose& pose) {
    std::array<Real, 12> numbers{};
    std::copy_n(pose.position.data(), 3, numbers.begin());
    std::copy_n(pose.rotation.data(), 9, numbers.begin() + 3);
    return numbers;
}

Mat3 rotation_of(const Real* numbers, const char* path, const std::string& body, const SavedFile& file) {
    const Mat3 rotation = Eigen::Map<const Mat3>(numbers);
    if (!is_rotation(rotation)) file.complain(path, "a matrix that is not a rotation for " + body, "a rotation matrix");
    return rotation;
}

/// Reads the pose at which a body was added. `body`: name of the body in messages.
RigidPose pose_of(const std::array<Real, 12>& numbers, const std::string& body, const SavedFile& file) {
    return {Eigen::Map<const Vec3>(numbers.data()), rotation_of(numbers.data() + 3, "records/body_start", body, file)};
}

/// Restores BodyRecord::mesh_shape. The list `shape` is empty unless the body became rigid in a deformed shape.
void put_mesh_shape(std::span<const Vec3> shape, std::size_t body, const SavedFile& file, Model& model) {
    BodyRecord& record = model.body_records[body];
    if (shape.empty()) return;
    const std::string name = "body " + std::to_string(body);
    if (!model.is_rigid(body) || shape.size() != static_cast<std::size_t>(model.bodies.nodes[body].size()))
        file.complain("records/mesh_shape", std::to_string(shape.size()) + " nodes for " + name,
                      "none, or one for each node of a rigid body");
    record.mesh_shape.assign(shape.begin(), shape.end());
    try {
        mesh::require_positive({.nodes = record.mesh_shape, .tetrahedra = record.tetrahedra}, name);
    } catch (const SceneError& error) {
        file.complain("records/mesh_shape", std::string("an invalid shape (") + error.what() + ")", "a valid mesh");
    }
}

SavedStart start_of(const RunRecord& record) {
    SavedStart saved;
    for (const StartOverlap& found : record.start_overlaps) {
        saved.overlap.push_back({found.first.slot, found.first.generation, found.second.slot, found.second.generation,
                                 found.collider.slot, found.collider.generation});
        saved.kind.push_back(found.kind);
        const Vec3 &d = found.direction, &x = found.place;
        saved.measure.push_back({found.depth, d.x(), d.y(), d.z(), x.x(), x.y(), x.z()});
        saved.resolved.push_back(found.resolved);
        append_text(found.first_name, saved.first_name);
        append_text(found.second_name, saved.second_name);
    }
    for (const StartMove& move : record.start_moves) {
        saved.moved.push_back({move.body.slot, move.body.generation});
        append_text(move.name, saved.moved_name);
        saved.translation.push_back(move.translation);
    }
    return saved;
}

}  // namespace

SavedRows rows_to_save(WorldState& world) {
    const Model& model = world.model;
    SavedRows saved;
    saved.step_size = model.settings.step_size.value_or(0);
    saved.world = model.body_map.world();
    saved.start = start_of(world.record);
    saved.meshes = meshes_of(model);
    for (const BodyRecord& record : model.body_records) {
        saved.body_element.push_back(record.element);
        saved.body_asked.push_back(record.requested_element);
        saved.body_settled.push_back(record.settled);
        saved.given_mass.push_back(record.given_mass);
        const DynamicsEstimate& e = record.choice;
        saved.choice_reason.push_back(e.reason);
        saved.choice_estimate.push_back({e.explicit_step, e.implicit_step, e.deforming_step, e.explicit_cost,
                                         e.implicit_cost, e.strain, e.damped_above});
        saved.body_start.push_back(numbers_of(record.start));
        std::array<Real, 9> built{};
        std::copy_n(record.built.data(), built.size(), built.begin());
        saved.body_built.push_back(built);
        append(std::span<const Vec3>(record.mesh_shape), saved.mesh_shape);
        append(std::span<const Index>(record.tetrahedron_material), saved.tetrahedron_material);
        append_text(record.name, saved.body_name);
    }
    saved.sets = sets_to_save(model);
    saved.visuals = visuals_to_save(model);
    for (const ColliderRecord& record : model.collider_records) {
        saved.shape_kind.push_back(static_cast<ColliderShape>(record.shape.index()));
        saved.shape_size.push_back(std::visit(SizeOf{}, record.shape));
        append_text(record.name, saved.collider_name);
        saved.collider_settled.push_back(record.settled);
    }
    world.model.for_each_joining([&](const char* table, auto& rows, auto& handles) {
        for (const std::uint32_t slot : rows.slot) {
            const auto given = handles.names.find(handles.handle_of_slot(slot));
            append_text(given == handles.names.end() ? "" : given->second, saved.object_name[table]);
        }
    });
    const PairTable& pairs = world.cache.pairs;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        append(pairs.candidates[p].span(), saved.candidates);
        for (const Real until : pairs.asleep_until[p]) saved.asleep_until.push_back(until);
        append(pairs.leaf_pairs[p].listed.span(), saved.leaf_pairs);
    }
    for (const StepLimitReport& entry : world.record.limits.entries()) {
        saved.limit.push_back(entry.limit);
        saved.limit_slot.push_back(entry.body.slot);
        saved.limit_generation.push_back(entry.body.generation);
        append_text(entry.body_name, saved.limit_name);
        saved.limit_steps.push_back(entry.steps);
        saved.limit_tries.push_back(entry.tries);
        saved.limit_seconds.push_back(entry.seconds);
    }
    for (const SelfCrossing& crossing : world.record.self_crossings) {
        saved.self_crossings.body.push_back({crossing.body.slot, crossing.body.generation});
        append_text(crossing.name, saved.self_crossings.name);
        saved.self_crossings.self_contact.push_back(crossing.self_contact);
        saved.self_crossings.time.push_back({crossing.first_time, crossing.last_time});
        saved.self_crossings.places.push_back({crossing.last_places, crossing.most_places});
    }
    // After a refused step the contacts are not saved: they may not be finite, and users cannot see them.
    if (world.scratch.findings.verdict.fault == StepFault::none) saved.contacts = world.scratch.contacts;
    return saved;
}

void put_records(const SavedRows& saved, const SavedFile& file, Model& model) {
    const std::size_t bodies = model.bodies.slot.size(), colliders = model.colliders.slot.size();
    const SavedMeshes& meshes = saved.meshes;
    const std::size_t count = meshes.nodes.size();
    expect_rows(file, "meshes/of_body", meshes.of_body.size(), bodies, "bodies");
    expect_ragged(file, "meshes/nodes", meshes.nodes, count, "meshes");
    expect_ragged(file, "meshes/tetrahedra", meshes.tetrahedra, count, "meshes");
    expect_ragged(file, "meshes/surface", meshes.surface, count, "meshes");
    expect_ragged(file, "meshes/covered_offset", meshes.covered_offset, count, "meshes");
    expect_ragged(file, "meshes/covered_item", meshes.covered_item, count, "meshes");
    expect_rows(file, "records/body_element", saved.body_element.size(), bodies, "bodies");
    expect_rows(file, "records/body_asked", saved.body_asked.size(), bodies, "bodies");
    expect_rows(file, "records/body_settled", saved.body_settled.size(), bodies, "bodies");
    expect_rows(file, "records/given_mass", saved.given_mass.size(), bodies, "bodies");
    expect_rows(file, "records/choice_reason", saved.choice_reason.size(), bodies, "bodies");
    expect_rows(file, "records/choice_estimate", saved.choice_estimate.size(), bodies, "bodies");
    expect_rows(file, "records/body_start", saved.body_start.size(), bodies, "bodies");
    expect_rows(file, "records/body_built", saved.body_built.size(), bodies, "bodies");
    expect_ragged(file, "records/mesh_shape", saved.mesh_shape, bodies, "bodies");
    expect_ragged(file, "records/tetrahedron_material", saved.tetrahedron_material, bodies, "bodies");
    expect_rows_of(file, "records/tetrahedron_material", saved.tetrahedron_material.item, model.materials.slot.size());
    expect_ragged(file, "records/body_name", saved.body_name, bodies, "bodies");
    if (saved.world == 0) file.complain("handles/world", "0", "the number of a world, an integer > 0");
    model.set_world(saved.world);
    model.for_each_joining([&](const char* table, auto& rows, auto& handles) {
        const Ragged<std::uint8_t>& names = saved.object_name.at(table);
        expect_ragged(file, std::string("names/") + table, names, rows.slot.size(), table);
        for (std::size_t row = 0; row < names.size(); ++row)
            if (names[row].size() > 0) handles.names[handles.handle_of_slot(rows.slot[row])] = text_of_row(names[row]);
    });
    for (std::size_t m = 0; m < count; ++m) check_mesh(meshes, m, file);

    model.nodes.rest_position.resize(model.nodes.position.size());
    for (std::size_t b = 0; b < bodies; ++b) {
        const std::string body = "body " + std::to_string(b);
        const Index m = meshes.of_body[b];
        if (m < 0 || m >= static_cast<Index>(count))
            file.complain("meshes/of_body", std::to_string(m) + " for " + body,
                          "the index of one of the " + std::to_string(count) + " meshes");
        const MeshParts parts = parts_of(meshes, static_cast<std::size_t>(m));
        const Range nodes = model.bodies.nodes[b];
        const bool deforms = model.bodies.kind[b] == BodyKind::deformable;
        if (parts.nodes.size() != static_cast<std::size_t>(nodes.size()) ||
            (parts.tetrahedra.empty() ? deforms && !model.is_rigid(b) : !deforms) ||
            static_cast<Index>(parts.tetrahedra.size()) != model.bodies.tetrahedron_count[b])
            file.complain("meshes/of_body",
                          "a mesh with " + std::to_string(parts.nodes.size()) + " nodes and " +
                              std::to_string(parts.tetrahedra.size()) + " tetrahedra for " + body,
                          std::to_string(nodes.size()) + " nodes and " +
                              std::to_string(model.bodies.tetrahedron_count[b]) +
                              " tetrahedra, as in bodies (no tetrahedra only for a rigid body or a mesh collider)");
        check_cover(parts, static_cast<std::size_t>(model.bodies.blocks[b].size()) * element_lanes, body, file);
        std::ranges::copy(parts.nodes, model.nodes.rest_position.begin() + nodes.begin);
        BodyRecord& record = model.body_records.emplace_back();
        record.name = text_of_row(saved.body_name[b]);
        record.element = saved.body_element[b];
        record.requested_element = saved.body_asked[b];
        record.settled = saved.body_settled[b] != 0;
        record.given_mass = saved.given_mass[b];
        const std::array<Real, 7>& e = saved.choice_estimate[b];
        if (std::ranges::any_of(e, [](Real value) { return !(value >= 0); }))
            file.complain("records/choice_estimate", "a negative number or NaN for " + body, "numbers >= 0");
        record.choice = {saved.choice_reason[b], e[0], e[1], e[2], e[3], e[4], e[5], e[6]};
        record.start = pose_of(saved.body_start[b], body, file);
        record.built = rotation_of(saved.body_built[b].data(), "records/body_built", body, file);
        record.tetrahedra.assign(parts.tetrahedra.begin(), parts.tetrahedra.end());
        put_mesh_shape(saved.mesh_shape[b], b, file, model);
        record.surface.assign(parts.surface.begin(), parts.surface.end());
        const std::span<const Index> materials = saved.tetrahedron_material[b];
        if (!materials.empty() && materials.size() != parts.tetrahedra.size())
            file.complain("records/tetrahedron_material", std::to_string(materials.size()) + " materials for " + body,
                          "none, or one for each of " + std::to_string(parts.tetrahedra.size()) + " tetrahedra");
        record.tetrahedron_material.assign(materials.begin(), materials.end());
        for (const Index at : parts.covered_offset) record.element_tetrahedra.offset.push_back(at);
        for (const Index t : parts.covered_item) record.element_tetrahedra.item.push_back(t);
    }
    put_sets(saved.sets, file, model);
    put_visuals(saved.visuals, file, model);

    expect_rows(file, "records/shape_kind", saved.shape_kind.size(), colliders, "colliders");
    expect_rows(file, "records/shape_size", saved.shape_size.size(), colliders, "colliders");
    expect_ragged(file, "records/collider_name", saved.collider_name, colliders, "colliders");
    expect_rows(file, "records/collider_settled", saved.collider_settled.size(), colliders, "colliders");
    for (std::size_t c = 0; c < colliders; ++c) {
        SurfaceMesh mesh;
        const Index body = model.colliders.body[c];
        if ((body == no_index) == (saved.shape_kind[c] == ColliderShape::mesh) ||
            model.colliders.geometry[c].shape != saved.shape_kind[c])
            file.complain("records/shape_kind",
                          "a shape of collider " + std::to_string(c) + " that contradicts the table of colliders",
                          "the shape in colliders/geometry/shape, a mesh only for a collider with a body");
        if (body != no_index) {
            const MeshParts parts = parts_of(meshes, static_cast<std::size_t>(meshes.of_body[body]));
            mesh = {{parts.nodes.begin(), parts.nodes.end()}, {parts.surface.begin(), parts.surface.end()}};
        }
        Shape shape = shape_of(saved.shape_kind[c], saved.shape_size[c], mesh);
        try {
            validate(shape, ColliderSettings{});
        } catch (const SceneError& error) {
            file.complain("records/shape_size",
                          "an invalid shape of collider " + std::to_string(c) + " (" + error.what() + ")",
                          "a valid shape");
        }
        model.collider_records.push_back(
            {text_of_row(saved.collider_name[c]), std::move(shape), saved.collider_settled[c] != 0});
    }
}

void put_candidates(const SavedRows& saved, const SavedFile& file, const Model& model, PairTable& pairs) {
    expect_ragged(file, "pairs/candidates", saved.candidates, pairs.size(), "pairs");
    expect_rows(file, "pairs/candidates/asleep_until", saved.asleep_until.size(), saved.candidates.item.size(),
                "candidates");
    expect_ragged(file, "pairs/leaf_pairs", saved.leaf_pairs, pairs.size(), "pairs");
    pairs.candidates.resize(pairs.size());
    pairs.asleep_until.resize(pairs.size());
    pairs.leaf_pairs.resize(pairs.size());
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const Index begin = saved.candidates.offset[p];
        for (const Candidate& candidate : saved.candidates[p]) {
            const auto row = pairs.asleep_until[p].size();
            pairs.candidates[p].push_back(candidate);
            pairs.asleep_until[p].push_back(saved.asleep_until[static_cast<std::size_t>(begin) + row]);
        }
        for (const LeafPair& pair : saved.leaf_pairs[p]) pairs.leaf_pairs[p].listed.push_back(pair);
    }
    check_candidates(file, model, pairs);
}

void put_limits(const SavedRows& saved, const SavedFile& file, StepLimits& limits) {
    const std::size_t count = saved.limit.size();
    constexpr const char* of = "limits";
    expect_rows(file, "run/limits/slot", saved.limit_slot.size(), count, of);
    expect_rows(file, "run/limits/generation", saved.limit_generation.size(), count, of);
    expect_ragged(file, "run/limits/name", saved.limit_name, count, of);
    expect_rows(file, "run/limits/steps", saved.limit_steps.size(), count, of);
    expect_rows(file, "run/limits/tries", saved.limit_tries.size(), count, of);
    expect_rows(file, "run/limits/seconds", saved.limit_seconds.size(), count, of);
    std::vector<StepLimitReport> entries(count);
    for (std::size_t i = 0; i < count; ++i)
        entries[i] = {.limit = saved.limit[i],
                      .body = handle_of<BodyHandle>(saved.limit_slot[i], saved.limit_generation[i], saved.world),
                      .body_name = text_of_row(saved.limit_name[i]),
                      .steps = saved.limit_steps[i],
                      .tries = saved.limit_tries[i],
                      .seconds = saved.limit_seconds[i]};
    limits.restore(std::move(entries));
}

void put_start(const SavedRows& saved, const SavedFile& file, RunRecord& record) {
    const SavedStart& start = saved.start;
    const std::size_t overlaps = start.overlap.size(), moves = start.moved.size();
    expect_rows(file, "run/start/kind", start.kind.size(), overlaps, "overlaps");
    expect_rows(file, "run/start/measure", start.measure.size(), overlaps, "overlaps");
    expect_rows(file, "run/start/resolved", start.resolved.size(), overlaps, "overlaps");
    expect_ragged(file, "run/start/first_name", start.first_name, overlaps, "overlaps");
    expect_ragged(file, "run/start/second_name", start.second_name, overlaps, "overlaps");
    expect_ragged(file, "run/start/moved_name", start.moved_name, moves, "moves");
    expect_rows(file, "run/start/translation", start.translation.size(), moves, "moves");
    for (std::size_t i = 0; i < overlaps; ++i) {
        const auto& of = start.overlap[i];
        const auto& m = start.measure[i];
        record.start_overlaps.push_back({.first = handle_of<BodyHandle>(of[0], of[1], saved.world),
                                         .second = handle_of<BodyHandle>(of[2], of[3], saved.world),
                                         .collider = handle_of<ColliderHandle>(of[4], of[5], saved.world),
                                         .first_name = text_of_row(start.first_name[i]),
                                         .second_name = text_of_row(start.second_name[i]),
                                         .kind = start.kind[i],
                                         .depth = m[0],
                                         .direction = {m[1], m[2], m[3]},
                                         .place = {m[4], m[5], m[6]},
                                         .resolved = start.resolved[i] != 0});
    }
    for (std::size_t i = 0; i < moves; ++i)
        record.start_moves.push_back({.body = handle_of<BodyHandle>(start.moved[i][0], start.moved[i][1], saved.world),
                                      .name = text_of_row(start.moved_name[i]),
                                      .translation = start.translation[i]});
}

void put_self_crossings(const SavedRows& saved, const SavedFile& file, RunRecord& record) {
    const SavedSelfCrossings& found = saved.self_crossings;
    const std::size_t count = found.body.size();
    constexpr const char* of = "bodies that cross themselves";
    expect_ragged(file, "run/self_crossings/name", found.name, count, of);
    expect_rows(file, "run/self_crossings/self_contact", found.self_contact.size(), count, of);
    expect_rows(file, "run/self_crossings/time", found.time.size(), count, of);
    expect_rows(file, "run/self_crossings/places", found.places.size(), count, of);
    for (std::size_t i = 0; i < count; ++i)
        record.self_crossings.push_back({.body = handle_of<BodyHandle>(found.body[i][0], found.body[i][1], saved.world),
                                         .name = text_of_row(found.name[i]),
                                         .self_contact = found.self_contact[i] != 0,
                                         .first_time = found.time[i][0],
                                         .last_time = found.time[i][1],
                                         .last_places = found.places[i][0],
                                         .most_places = found.places[i][1]});
}

}  // namespace skerry
