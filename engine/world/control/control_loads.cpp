// Functions that add, remove and change loads between steps (docs/methods/loads.md).
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/mesh/sets.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/objects.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"
#include "skerry/load.h"
#include "systems/forces/add_loads.h"
#include "systems/forces/cavities.h"

namespace skerry {

namespace {

/// The values of a row of LoadTable.
struct LoadRow {
    LoadKind kind;
    Index body;  // no_index: all bodies
    Vec3 vector;
    Real rate = 0;
    LoadArea area = LoadArea::reference;
    std::vector<Index> node{};
    std::vector<Real> weight{};
    std::vector<std::array<Index, 3>> face{};
};

/// Wakes the body that a load acts on, or all bodies if `body` is no_index.
void wake_loaded(Model& model, Index body) {
    if (body == no_index)
        model.wake_all();
    else
        model.wake(static_cast<std::size_t>(body));
}

/// Title of a load on a body, or on all bodies if `body` is no_index.
std::string title_of_load(const Model& model, Index body) {
    if (body == no_index) return "load on all bodies";
    return "load on body '" + model.body_records[static_cast<std::size_t>(body)].name + "'";
}

LoadHandle append_load(World& world, const LoadRow& row, const TimeTable& scale) {
    WorldState& state = WorldAccess::state_of(world);
    Model& model = state.model;
    require_table(title_of_load(model, row.body), "scale", scale);
    LoadTable& table = model.loads;
    const std::size_t place = table.size();
    AnyTable(table).resize(place + 1);
    const LoadHandle handle = model.load_map.insert(static_cast<Index>(place));
    table.slot[place] = handle.slot;
    table.kind[place] = row.kind;
    table.body[place] = row.body;
    table.vector[place] = row.vector;
    table.rate[place] = row.rate;
    table.area[place] = row.area;
    const auto first = static_cast<Index>(table.node.size());
    for (const Index node : row.node) table.node.push_back(node);
    for (const Real weight : row.weight) table.weight.push_back(weight);
    if (!row.node.empty()) table.nodes[place] = {first, static_cast<Index>(table.node.size())};
    const auto first_face = static_cast<Index>(table.face.size());
    for (const std::array<Index, 3>& face : row.face) table.face.push_back(face);
    table.faces[place] = {first_face, static_cast<Index>(table.face.size())};
    set_keys(table.scale_keys, table.key, place, scale.keys);
    wake_loaded(model, row.body);
    note_forces(model);
    return handle;
}

/// Row of the body on which a force field acts; no_index: all bodies. Throws SceneError for a stale handle.
Index body_of_field(const Model& model, const std::optional<BodyHandle>& body) {
    return body ? model.row(*body, "add_load") : no_index;
}

/// Throws SceneError if the body is round and thus has no faces, if the list is empty, or if a face is listed twice or
/// is not on the surface of the body.
void require_faces(std::span<const std::array<Index, 3>> faces, const Model& model, std::size_t body) {
    const std::string object = title_of_load(model, static_cast<Index>(body));
    const BodyRecord& record = model.body_records[body];
    if (model.bodies.core_nodes[body] > 0)
        refuse(object, "faces",
               "faces of body '" + record.name + "', which is a " + std::string(model.round_name(body)),
               "a body with a mesh");
    if (faces.empty()) refuse(object, "faces", "an empty list", "at least one face");
    std::set<std::array<Index, 3>> unmatched;
    for (const std::array<Index, 3>& face : record.surface) unmatched.insert(mesh::sorted_face(face));
    for (const std::array<Index, 3>& face : faces)
        if (unmatched.erase(mesh::sorted_face(face)) == 0)
            refuse(object, "faces",
                   "the face of the nodes " + std::to_string(face[0]) + ", " + std::to_string(face[1]) + " and " +
                       std::to_string(face[2]),
                   "faces of the surface of body '" + record.name + "', each at most once");
}

const std::string& name_of_row(const Model& model, Index body) {
    return model.body_records[static_cast<std::size_t>(body)].name;
}

const char* field_of_vector(LoadKind kind) {
    return kind == LoadKind::force      ? "force"
           : kind == LoadKind::traction ? "traction"
           : kind == LoadKind::drag     ? "wind"
                                        : "acceleration";
}

/// Present total force of a load, summed over the nodes [N].
Vec3 force_of_load(const Model& model, std::size_t row, Real scale) {
    const LoadTable& table = model.loads;
    const LoadInputs loads =
        LoadInputs::bind({}, table, model.bodies, model.nodes, model.settings.gravity, ForceIntervals{});
    Vec3 sum = Vec3::Zero();
    if (loads.is_on_present_area(row)) {
        loads.for_each_face(
            row, [&](std::size_t, const Mat3& corners) { sum += area_of(corners).norm() * scale * table.vector[row]; });
        return sum;
    }
    for (const Real weight : table.weights_of(row)) sum += weight * scale * table.vector[row];
    if (table.nodes[row].size() > 0) return sum;
    for (std::size_t body = 0; body < model.bodies.slot.size(); ++body) {
        if (!loads.acts_on(row, body)) continue;
        for (Index n = model.bodies.nodes[body].begin; n < model.bodies.nodes[body].end; ++n) {
            Vec3 acceleration = scale * table.vector[row];
            if (table.kind[row] == LoadKind::gravity) acceleration = (scale - 1) * model.settings.gravity;
            if (table.kind[row] == LoadKind::drag)
                acceleration = table.rate[row] * (acceleration - model.nodes.velocity[n]);
            sum += model.nodes.mass[n] * acceleration;
        }
    }
    return sum;
}

}  // namespace

LoadHandle Loads::add(const ForceLoad& load) {
    const Model& model = state_between_steps(*world_, "add_load").model;
    const Index body = model.row(load.body, "add_load");
    const Range nodes = model.bodies.nodes[static_cast<std::size_t>(body)];
    const std::string object = title_of_load(model, body);
    require_finite(object, "force", load.force);
    if (load.nodes.empty()) refuse(object, "nodes", "an empty list", "at least one node");
    require_different_nodes(object, load.nodes, nodes.size());
    LoadRow row{.kind = LoadKind::force, .body = body, .vector = load.force, .node = load.nodes};
    Real total = 0;
    const auto mass = [&](Index node) { return model.weight_of_node(static_cast<std::size_t>(nodes.begin + node)); };
    for (const Index node : load.nodes) total += mass(node);
    if (!(total > 0)) refuse(object, "nodes", "nodes without mass", "at least one node with a mass");
    for (const Index node : load.nodes) row.weight.push_back(mass(node) / total);
    return append_load(*world_, row, load.scale);
}

LoadHandle Loads::add(const TractionLoad& load) {
    const Model& model = state_between_steps(*world_, "add_load").model;
    const Index body = model.row(load.body, "add_load");
    require_finite(title_of_load(model, body), "traction", load.traction);
    const std::span<const Vec3> rest =
        rows_of(model.nodes.rest_position, model.bodies.nodes[static_cast<std::size_t>(body)]);
    require_faces(load.faces, model, static_cast<std::size_t>(body));
    LoadRow row{
        .kind = LoadKind::traction, .body = body, .vector = load.traction, .area = load.area, .face = load.faces};
    if (load.area == LoadArea::present) {
        std::vector<Real> faces_at(rest.size(), 0);  // for each node: number of loaded faces that contain it
        for (const auto& face : load.faces)
            for (const Index node : face) ++faces_at[static_cast<std::size_t>(node)];
        for (const auto& face : load.faces)
            for (const Index node : face) {
                row.node.push_back(node);
                row.weight.push_back(faces_at[static_cast<std::size_t>(node)]);
            }
        return append_load(*world_, row, load.scale);
    }
    std::vector<Real> of_node(rest.size(), 0);  // for each node: a third of the area of its loaded faces [m^2]
    for (const auto& [a, b, c] : load.faces) {
        const Vec3& first = rest[static_cast<std::size_t>(a)];
        const Vec3 twice_area =
            (rest[static_cast<std::size_t>(b)] - first).cross(rest[static_cast<std::size_t>(c)] - first);
        for (const Index node : {a, b, c}) of_node[static_cast<std::size_t>(node)] += twice_area.norm() / 6;
    }
    for (std::size_t n = 0; n < of_node.size(); ++n) {
        if (!(of_node[n] > 0)) continue;
        row.node.push_back(static_cast<Index>(n));
        row.weight.push_back(of_node[n]);
    }
    return append_load(*world_, row, load.scale);
}

LoadHandle Loads::add(const AccelerationField& field) {
    const Model& model = state_between_steps(*world_, "add_load").model;
    const Index body = body_of_field(model, field.body);
    require_finite(title_of_load(model, body), "acceleration", field.acceleration);
    return append_load(*world_, {.kind = LoadKind::acceleration, .body = body, .vector = field.acceleration},
                       field.scale);
}

LoadHandle Loads::add(const GravityScale& factor) {
    const Model& model = state_between_steps(*world_, "add_load").model;
    const Index body = body_of_field(model, factor.body);
    for (std::size_t row = 0; row < model.loads.size(); ++row)
        if (model.loads.kind[row] == LoadKind::gravity && model.loads.body[row] == body)
            refuse(title_of_load(model, body), "body",
                   "a second factor of the weight of " +
                       (body == no_index ? "all bodies" : "body '" + name_of_row(model, body) + "'"),
                   "one factor, which set_scale() changes");
    return append_load(*world_, {.kind = LoadKind::gravity, .body = body, .vector = Vec3::Zero()}, factor.scale);
}

LoadHandle Loads::add(const DragField& drag) {
    const Model& model = state_between_steps(*world_, "add_load").model;
    const Index body = body_of_field(model, drag.body);
    if (!(std::isfinite(drag.rate) && drag.rate > 0))
        refuse(title_of_load(model, body), "rate", short_text(drag.rate), "a finite number > 0 (1/s)");
    require_finite(title_of_load(model, body), "wind", drag.wind);
    return append_load(*world_, {.kind = LoadKind::drag, .body = body, .vector = drag.wind, .rate = drag.rate},
                       drag.scale);
}

void prepare_removal(World& world, LoadHandle load) {
    Model& model = WorldAccess::state_of(world).model;
    wake_loaded(model, model.loads.body[static_cast<std::size_t>(model.load_map.row(load))]);
}

LoadState Loads::state(LoadHandle load) const {
    const WorldState& state = WorldAccess::state_of(*world_);
    const Model& model = state.model;
    const auto row = static_cast<std::size_t>(model.row(load, "load"));
    LoadState now{.kind = model.loads.kind[row], .vector = model.loads.vector[row], .rate = model.loads.rate[row]};
    if (const Index body = model.loads.body[row]; body != no_index) now.body = handle_of_body(model, body);
    now.scale = value_at(model.loads.keys_of(row), state.clock.time);
    now.force = force_of_load(model, row, now.scale);
    return now;
}

AnyLoad Loads::settings(LoadHandle load) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const LoadTable& table = model.loads;
    const auto row = static_cast<std::size_t>(model.row(load, "settings"));
    const TimeTable scale = time_table_of(table.keys_of(row));
    const std::span<const Index> nodes = table.nodes_of(row);
    const std::span<const std::array<Index, 3>> faces = rows_of(table.face.span(), table.faces[row]);
    std::optional<BodyHandle> body;
    if (table.body[row] != no_index) body = handle_of_body(model, table.body[row]);
    switch (table.kind[row]) {
        case LoadKind::force:
            return ForceLoad{*body, {nodes.begin(), nodes.end()}, table.vector[row], scale};
        case LoadKind::traction:
            return TractionLoad{*body, {faces.begin(), faces.end()}, table.vector[row], scale, table.area[row]};
        case LoadKind::acceleration:
            return AccelerationField{body, table.vector[row], scale};
        case LoadKind::gravity:
            return GravityScale{body, scale};
        case LoadKind::drag:
            break;
    }
    return DragField{body, table.rate[row], table.vector[row], scale};
}

void Loads::set_scale(LoadHandle load, const TimeTable& scale) {
    Model& model = state_between_steps(*world_, "set_scale").model;
    const auto row = static_cast<std::size_t>(model.row(load, "set_scale"));
    require_table(title_of_load(model, model.loads.body[row]), "scale", scale);
    if (std::ranges::equal(model.loads.keys_of(row), scale.keys)) return;
    set_keys(model.loads.scale_keys, model.loads.key, row, scale.keys);
    wake_loaded(model, model.loads.body[row]);
    note_forces(model);
}

void Loads::set_vector(LoadHandle load, const Vec3& vector) {
    Model& model = state_between_steps(*world_, "set_vector").model;
    const auto row = static_cast<std::size_t>(model.row(load, "set_vector"));
    const std::string object = title_of_load(model, model.loads.body[row]);
    if (model.loads.kind[row] == LoadKind::gravity)
        refuse(object, "vector", "a vector for a factor of the weight",
               "a load of another kind; use set_scale() for the factor, or World::set_gravity()");
    require_finite(object, field_of_vector(model.loads.kind[row]), vector);
    if (model.loads.vector[row] == vector) return;
    model.loads.vector[row] = vector;
    wake_loaded(model, model.loads.body[row]);
    note_forces(model);
}

}  // namespace skerry
