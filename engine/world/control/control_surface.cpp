// Friction and restitution of material pairs, and of sets of faces and nodes of a body (docs/methods/friction.md 4).
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/validate.h"
#include "skerry/surface.h"

namespace skerry {

namespace {

void wake_bodies_of(Model& model, Index first, Index second) {
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (const Index material = model.bodies.material[b];
            material != no_index && (material == first || material == second))
            model.wake(b);
}

MaterialHandle material_handle(const Model& model, Index row) {
    return model.material_map.handle_of_slot(model.materials.slot[static_cast<std::size_t>(row)]);
}

/// Rows of the materials of a pair.
struct PairRows {
    Index first, second;
};
PairRows rows_of_pair(const Model& model, MaterialHandle first, MaterialHandle second, const char* call) {
    return {model.row(first, call), model.row(second, call)};
}

std::string title_of(const Model& model, std::size_t body) {
    return "surface set of body '" + model.body_records[body].name + "'";
}

/// Ratio of the friction coefficients across and along the direction of a set; 1 without `across`. Throws SceneError if
/// a value is out of range, or if `across` is given without a direction or without a positive dynamic friction
/// coefficient along it.
Real checked_ratio(const std::string& object, const SurfaceSettings& surface, const std::optional<Real>& across,
                   bool has_direction) {
    validate(surface, object);
    if (!across) return 1;
    if (!has_direction)
        refuse(object, "friction_across", short_text(*across), "no value for a set without a direction");
    if (!(*across > 0 && std::isfinite(*across)))
        refuse(object, "friction_across", short_text(*across), "a number > 0");
    const Real along = surface_properties(surface).dynamic_friction;
    if (!(along > 0))
        refuse(object, "friction", along < 0 ? "no value" : "0", "a number > 0, because friction_across is given");
    return *across / along;
}

void require_faces(const Model& model, std::size_t body, std::span<const std::array<Index, 3>> faces,
                   const std::string& object) {
    for (std::size_t i = 0; i < faces.size(); ++i) require_nodes(object, faces[i], model.bodies.nodes[body].size());
    const std::vector<Index> found = model.triangles_of(body, faces);
    std::set<Index> listed;
    for (std::size_t i = 0; i < faces.size(); ++i)
        if (found[i] == no_index || !listed.insert(found[i]).second)
            refuse(object, "faces[" + std::to_string(i) + "]",
                   "nodes " + std::to_string(faces[i][0]) + ", " + std::to_string(faces[i][1]) + ", " +
                       std::to_string(faces[i][2]),
                   "the three nodes of a face on the surface of the body, each face at most once");
}

}  // namespace

void SurfacePairs::set(MaterialHandle first, MaterialHandle second, const SurfaceSettings& surface) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set");
    Model& model = state.model;
    const PairRows rows = rows_of_pair(model, first, second, "set");
    validate(surface, "pair of materials");
    const SurfaceProperties next = surface_properties(surface);
    MaterialPairTable& table = model.material_pairs;
    const std::size_t row = table.place_of(rows.first, rows.second);
    if (!table.is_pair(row, rows.first, rows.second)) {
        AnyTable(table).resize(table.size() + 1);
        for (std::size_t r = table.size() - 1; r > row; --r) {
            table.first[r] = table.first[r - 1];
            table.second[r] = table.second[r - 1];
            table.surface[r] = table.surface[r - 1];
        }
        table.first[row] = std::min(rows.first, rows.second);
        table.second[row] = std::max(rows.first, rows.second);
    } else if (table.surface[row] == next) {
        return;
    }
    table.surface[row] = next;
    wake_bodies_of(model, rows.first, rows.second);
}

void SurfacePairs::remove(MaterialHandle first, MaterialHandle second) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("remove");
    Model& model = state.model;
    const PairRows rows = rows_of_pair(model, first, second, "remove");
    MaterialPairTable& table = model.material_pairs;
    const auto row = static_cast<Index>(table.place_of(rows.first, rows.second));
    if (!table.is_pair(static_cast<std::size_t>(row), rows.first, rows.second)) return;
    const Range removed{row, row + 1};
    AnyTable(table).erase({&removed, 1});
    wake_bodies_of(model, rows.first, rows.second);
}

std::optional<SurfaceSettings> SurfacePairs::surface(MaterialHandle first, MaterialHandle second) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const PairRows rows = rows_of_pair(model, first, second, "surface");
    const std::size_t row = model.material_pairs.place_of(rows.first, rows.second);
    if (!model.material_pairs.is_pair(row, rows.first, rows.second)) return {};
    return set_values_of(model.material_pairs.surface[row]);
}

std::vector<MaterialPair> SurfacePairs::all() const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const MaterialPairTable& table = model.material_pairs;
    std::vector<MaterialPair> pairs;
    for (std::size_t row = 0; row < table.size(); ++row)
        pairs.push_back({material_handle(model, table.first[row]), material_handle(model, table.second[row]),
                         set_values_of(table.surface[row])});
    return pairs;
}

void SurfacePairs::set_material(ColliderHandle collider, std::optional<MaterialHandle> material) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_material");
    Model& model = state.model;
    const auto row = static_cast<std::size_t>(model.row(collider, "set_material"));
    const Index next = material ? model.row(*material, "set_material") : no_index;
    if (model.colliders.material[row] == next) return;
    model.colliders.material[row] = next;
    state.edits.places.add_collider(model, row, world_->time());  // wakes bodies that lie on the collider
}

std::optional<MaterialHandle> SurfacePairs::material(ColliderHandle collider) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const Index row = model.colliders.material[static_cast<std::size_t>(model.row(collider, "material"))];
    if (row == no_index) return {};
    return material_handle(model, row);
}

SurfaceSetHandle SurfaceSets::add(const SurfaceSetSettings& set) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("add");
    state.settle();
    Model& model = state.model;
    const Index body = model.row(set.body, "add");
    const auto b = static_cast<std::size_t>(body);
    const std::string object = title_of(model, b);
    if (model.bodies.core_nodes[b] > 0)
        refuse(object, "body", std::string("a ") + model.round_name(b), "a body with faces");
    const Real across = checked_ratio(object, set.surface, set.friction_across, set.direction.has_value());
    if (set.direction) {
        require_finite(object, "direction", *set.direction);
        if (!(set.direction->norm() > 0))
            refuse(object, "direction", "a vector of length 0", "a vector that is not zero");
    }
    require_different_nodes(object, set.nodes, model.bodies.nodes[b].size());
    require_faces(model, b, set.faces, object);
    if (set.nodes.empty() && set.faces.empty()) refuse(object, "nodes", "no node and no face", "at least one of them");
    SurfaceSetTable& table = model.surface_sets;
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const SurfaceSetHandle handle = model.surface_set_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    table.body[row] = body;
    table.surface[row] = surface_properties(set.surface);
    table.direction[row] = set.direction ? set.direction->normalized() : Vec3(Vec3::Zero());
    table.across[row] = across;
    table.members[row].begin = static_cast<Index>(table.member.size());
    for (const std::array<Index, 3>& face : set.faces) table.member.push_back(face);
    for (const Index node : set.nodes) table.member.push_back({node, node, node});
    table.members[row].end = static_cast<Index>(table.member.size());
    model.wake(b);
    model.links_open = true;
    return handle;
}

SurfaceSetSettings SurfaceSets::settings(SurfaceSetHandle set) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const SurfaceSetTable& table = model.surface_sets;
    const auto row = static_cast<std::size_t>(model.row(set, "settings"));
    SurfaceSetSettings settings;
    settings.body = handle_of_body(model, table.body[row]);
    for (const std::array<Index, 3>& member : table.members_of(row)) {
        if (member[0] == member[1])
            settings.nodes.push_back(member[0]);
        else
            settings.faces.push_back(member);
    }
    settings.surface = set_values_of(table.surface[row]);
    if (!table.direction[row].isZero(0)) settings.direction = table.direction[row];
    if (table.across[row] != 1) settings.friction_across = table.across[row] * table.surface[row].dynamic_friction;
    return settings;
}

void SurfaceSets::set_surface(SurfaceSetHandle set, const SurfaceSettings& surface,
                              std::optional<Real> friction_across) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_surface");
    Model& model = state.model;
    SurfaceSetTable& table = model.surface_sets;
    const auto row = static_cast<std::size_t>(model.row(set, "set_surface"));
    const auto body = static_cast<std::size_t>(table.body[row]);
    const Real across = checked_ratio(title_of(model, body), surface, friction_across, !table.direction[row].isZero(0));
    const SurfaceProperties next = surface_properties(surface);
    if (table.surface[row] == next && table.across[row] == across) return;
    table.surface[row] = next;
    table.across[row] = across;
    model.wake(body);
}

}  // namespace skerry
