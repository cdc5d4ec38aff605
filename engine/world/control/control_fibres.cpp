// Functions that add, read and change fibres between steps (docs/methods/elasticity.md 2.7).
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"
#include "skerry/fibre.h"
#include "systems/dynamics/kinds/element_list.h"
#include "systems/forces/fibres.h"

namespace skerry {

namespace {

std::string title_of_fibres(const Model& model, Index body) {
    return "fibres in body '" + model.body_records[static_cast<std::size_t>(body)].name + "'";
}

// In the following functions `object` names the fibres in error messages (title_of_fibres).

void require_tension(const std::string& object, const TimeTable& tension) {
    require_table(object, "tension", tension);
    for (const TimeKey& key : tension.keys)
        if (!(key.value >= 0)) refuse(object, "tension", short_text(key.value), "a tension >= 0 (Pa)");
}

void require_modulus(const std::string& object, const char* field, Real found, const char* expected) {
    if (!(std::isfinite(found) && found >= 0)) refuse(object, field, short_text(found), expected);
}

/// Throws SceneError if the body is a collider mesh, a rigid body, or an implicit body while Settings::theta is below
/// 1. Fibre forces follow the deformation and would add energy to such an implicit body.
void require_deforming(const Model& model, std::size_t body, const std::string& object) {
    if (model.bodies.kind[body] != BodyKind::deformable || model.is_rigid(body))
        refuse(object, "body", "a body that does not deform", "an explicit or implicit body");
    if (model.settings.theta != 1 && model.dynamics_of(body) == BodyDynamics::implicit_elastic)
        refuse(object, "body", "an implicit body in a world with theta " + short_text(model.settings.theta),
               "theta 1 in the settings, or an explicit body");
}

/// Tetrahedra of the fibres; all `count` tetrahedra of the body if the settings list none. Throws SceneError if a
/// number is out of range or repeated.
std::vector<Index> tetrahedra_with(const FibreSettings& fibres, std::size_t count, const std::string& object) {
    std::vector<Index> tetrahedra = fibres.tetrahedra;
    if (tetrahedra.empty()) {
        tetrahedra.resize(count);
        std::iota(tetrahedra.begin(), tetrahedra.end(), Index{0});
        return tetrahedra;
    }
    std::vector<bool> taken(count, false);
    for (const Index t : tetrahedra) {
        if (t < 0 || t >= static_cast<Index>(count) || taken[static_cast<std::size_t>(t)])
            refuse(object, "tetrahedra", "tetrahedron " + std::to_string(t),
                   "numbers from 0 to " + std::to_string(count - 1) + ", each at most once");
        taken[static_cast<std::size_t>(t)] = true;
    }
    return tetrahedra;
}

void require_directions(const std::vector<Vec3>& direction, std::size_t count, const std::string& object) {
    if (direction.size() != 1 && direction.size() != count)
        refuse(object, "direction", std::to_string(direction.size()) + " directions",
               "one direction, or one for each of the " + std::to_string(count) + " tetrahedra");
    for (std::size_t t = 0; t < direction.size(); ++t)
        if (!(direction[t].allFinite() && direction[t].norm() > 0))
            refuse(object, "direction", short_text(direction[t]) + " at place " + std::to_string(t),
                   "a vector that is not zero");
}

/// Completes a change of fibres: wakes the body, updates the data of force elements, and starts a new energy balance,
/// which does not count the energy of the change as an error.
void note_fibres(WorldState& world, Index body) {
    world.model.wake(static_cast<std::size_t>(body));
    note_forces(world.model);
    world.record.balance.close();
}

}  // namespace

FibreHandle Fibres::add(const FibreSettings& fibres) {
    WorldState& world = state_between_steps(*world_, "add_fibres");
    Model& model = world.model;
    const Index body = model.row(fibres.body, "add_fibres");
    const auto b = static_cast<std::size_t>(body);
    const std::string object = title_of_fibres(model, body);
    require_deforming(model, b, object);
    require_modulus(object, "stiffness", fibres.stiffness, "a modulus >= 0 (Pa)");
    require_modulus(object, "exponent", fibres.exponent, "a number >= 0");
    require_tension(object, fibres.tension);
    const std::vector<std::array<Index, 4>>& mesh = model.body_records[b].tetrahedra;
    const std::vector<Index> tetrahedra = tetrahedra_with(fibres, mesh.size(), object);
    require_directions(fibres.direction, tetrahedra.size(), object);
    FibreTable& table = model.fibres;
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const FibreHandle handle = model.fibre_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    table.body[row] = body;
    table.stiffness[row] = fibres.stiffness;
    table.exponent[row] = fibres.exponent;
    const auto first = static_cast<Index>(table.node.size());
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[b]);
    for (std::size_t i = 0; i < tetrahedra.size(); ++i) {
        const std::array<Index, 4>& nodes = mesh[static_cast<std::size_t>(tetrahedra[i])];
        const TetrahedronGradients of = tetrahedron_gradients(nodes, rest);
        const Vec3 along = fibres.direction[fibres.direction.size() == 1 ? 0 : i].normalized();
        table.tetrahedron.push_back(tetrahedra[i]);
        table.node.push_back(nodes);
        table.slope.push_back({along.dot(of.g[0]), along.dot(of.g[1]), along.dot(of.g[2]), along.dot(of.g[3])});
        table.volume.push_back(of.volume);
        table.passive.push_back(Vec3::Zero());
    }
    table.tetrahedra[row] = {first, static_cast<Index>(table.node.size())};
    table.tension_keys[row] = {};
    set_keys(table.tension_keys, table.key, row, fibres.tension.keys);
    note_fibres(world, body);
    return handle;
}

BodyHandle Fibres::body(FibreHandle fibres) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    return handle_of_body(model, model.fibres.body[static_cast<std::size_t>(model.row(fibres, "body"))]);
}

FibreState Fibres::state(FibreHandle fibres) const {
    return fibre_state(WorldAccess::state_of(*world_), fibres);
}

FibreState fibre_state(const WorldState& world, FibreHandle fibres) {
    const Model& model = world.model;
    const FibreTable& table = model.fibres;
    const auto row = static_cast<std::size_t>(model.row(fibres, "fibres"));
    const FibreInputs inputs = FibreInputs::bind({}, table, model.bodies, model.nodes);
    const FibreLaw law = inputs.law(row);
    FibreState state;
    state.body = handle_of_body(model, table.body[row]);
    state.tension = value_at(table.keys_of(row), world.clock.time);
    for (auto t = static_cast<std::size_t>(table.tetrahedra[row].begin);
         t < static_cast<std::size_t>(table.tetrahedra[row].end); ++t) {
        const Vec3 y = inputs.stretched(row, t);
        state.energy += table.volume[t] * law.energy(y.squaredNorm());
        state.tetrahedra.push_back(table.tetrahedron[t]);
        state.stretch.push_back(y.norm());
        state.stress.push_back(law.pull(y, state.tension).whole.norm());
    }
    return state;
}

FibreSettings Fibres::settings(FibreHandle fibres) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const FibreTable& table = model.fibres;
    const auto row = static_cast<std::size_t>(model.row(fibres, "settings"));
    const auto body = static_cast<std::size_t>(table.body[row]);
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[body]);
    FibreSettings settings{.body = handle_of_body(model, table.body[row]),
                           .tetrahedra = {},
                           .direction = {},
                           .stiffness = table.stiffness[row],
                           .exponent = table.exponent[row],
                           .tension = time_table_of(table.keys_of(row))};
    for (auto t = static_cast<std::size_t>(table.tetrahedra[row].begin);
         t < static_cast<std::size_t>(table.tetrahedra[row].end); ++t) {
        settings.tetrahedra.push_back(table.tetrahedron[t]);
        // Restores the direction d: it is the sum over the nodes of (derivative of the node's shape function along d) *
        // (rest position of the node).
        Vec3 along = Vec3::Zero();
        for (std::size_t a = 0; a < 4; ++a)
            along += table.slope[t][a] * rest[static_cast<std::size_t>(table.node[t][a])];
        settings.direction.push_back(along);
    }
    return settings;
}

void Fibres::set_tension(FibreHandle fibres, const TimeTable& tension) {
    WorldState& world = state_between_steps(*world_, "set_tension");
    Model& model = world.model;
    const auto row = static_cast<std::size_t>(model.row(fibres, "set_tension"));
    require_tension(title_of_fibres(model, model.fibres.body[row]), tension);
    if (std::ranges::equal(model.fibres.keys_of(row), tension.keys)) return;
    set_keys(model.fibres.tension_keys, model.fibres.key, row, tension.keys);
    model.wake(static_cast<std::size_t>(model.fibres.body[row]));
    note_forces(model);
}

}  // namespace skerry
