// Functions that add, remove and control cavities and pipes between steps (docs/methods/cavities.md).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/joining_rows.h"
#include "engine/world/edit/objects.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "systems/forces/cavities.h"

namespace skerry {

namespace {

using Face = std::array<Index, 3>;

std::string title_of_cavity(const Model& model, std::size_t body) {
    return "cavity of body '" + model.body_records[body].name + "'";
}

std::string title_of_row(const Model& model, std::size_t cavity) {
    return title_of_cavity(model, static_cast<std::size_t>(model.cavities.body[cavity]));
}

void require_above(const std::string& object, const char* field, Real value, Real least, const char* unit) {
    if (!(std::isfinite(value) && value > least))
        refuse(object, field, short_text(value), "a number > " + short_text(least) + unit);
}

/// Throws SceneError if a list of keys is empty, if its times do not ascend, or if a value is not finite or not greater
/// than `least`.
void require_keys(const std::string& object, const char* field, const TimeTable& table, Real least, const char* unit) {
    require_table(object, field, table);
    for (const TimeKey& key : table.keys) require_above(object, field, key.value, least, unit);
}

Vec3 rest_area(const Model& model, std::size_t body, const Face& face, Vec3& corner) {
    const Index first = model.bodies.nodes[body].begin;
    Mat3 x;
    for (int k = 0; k < 3; ++k) x.col(k) = model.nodes.rest_position[first + face[static_cast<std::size_t>(k)]];
    corner = x.col(0);
    return area_of(x);
}

/// Faces around all hollows inside a body, or all faces of its surface if there is no hollow. The boundary of a hollow
/// is a connected part of the surface with a negative signed volume, because its normals point out of the body, which
/// is into the enclosed space.
std::vector<Face> faces_of_hollows(const Model& model, std::size_t body) {
    const std::vector<Face>& surface = model.body_records[body].surface;
    std::vector<std::size_t> parent(static_cast<std::size_t>(model.bodies.nodes[body].size()));
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto root = [&](Index node) {
        auto n = static_cast<std::size_t>(node);
        while (parent[n] != n) n = parent[n] = parent[parent[n]];
        return n;
    };
    for (const Face& face : surface)
        for (const Index n : face) parent[root(n)] = root(face[0]);
    std::vector<Real> outward(parent.size(), 0);  // by root of a connected part: its signed volume [m^3]
    for (const Face& face : surface) {
        Vec3 corner;
        const Vec3 area = rest_area(model, body, face, corner);
        outward[root(face[0])] += area.dot(corner) / 3;
    }
    std::vector<Face> faces;
    for (const Face& face : surface)
        if (outward[root(face[0])] < 0) faces.push_back(face);
    return faces.empty() ? surface : faces;
}

Face sorted(Face face) {
    std::ranges::sort(face);
    return face;
}

/// Faces of a cavity, in the orientation of the surface: `user_faces`, or by default faces_of_hollows. Throws
/// SceneError if the body has no mesh, or if `user_faces` is empty, repeats a face, or has a face that is not on the
/// surface.
std::vector<Face> chosen_faces(const Model& model, std::size_t body, const std::string& object,
                               const std::optional<std::vector<Face>>& user_faces) {
    if (model.bodies.core_nodes[body] > 0)
        refuse(object, "body", std::string("a ") + model.round_name(body) + ", which has no faces",
               "a body with a mesh");
    if (!user_faces) return faces_of_hollows(model, body);
    if (user_faces->empty()) refuse(object, "faces", "no faces", "at least one face of the surface");
    std::map<Face, Face> surface;  // key: sorted nodes; value: face as oriented on the surface
    for (const Face& face : model.body_records[body].surface) surface.emplace(sorted(face), face);
    std::vector<Face> faces;
    for (const Face& face : *user_faces) {
        const auto found = surface.extract(sorted(face));
        if (found.empty())
            refuse(object, "faces",
                   "the nodes " + std::to_string(face[0]) + ", " + std::to_string(face[1]) + " and " +
                       std::to_string(face[2]),
                   "three nodes of a face of the surface, each face once");
        faces.push_back(found.mapped());
    }
    return faces;
}

/// Returns an edge that shows that the faces do not form a closed surface, or {no_index, no_index} if there is none. In
/// a closed surface an edge is passed by equally many faces in each direction; at the returned edge these numbers
/// differ.
std::pair<Index, Index> open_edge(const std::vector<Face>& faces) {
    std::map<std::pair<Index, Index>, int> sum;
    for (const Face& face : faces)
        for (std::size_t k = 0; k < face.size(); ++k) {
            const Index a = face[k], b = face[(k + 1) % face.size()];
            sum[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    for (const auto& [edge, difference] : sum)
        if (difference != 0) return edge;
    return {no_index, no_index};
}

CavityFluid fluid_of(const std::string& object, const GasFilling& gas) {
    require_above(object, "gas.ambient", gas.ambient, 0, " (Pa)");
    require_above(object, "gas.pressure", gas.pressure, -gas.ambient, " (Pa), which is vacuum");
    require_above(object, "gas.density", gas.density, 0, " (kg/m^3)");
    if (!(std::isfinite(gas.exponent) && gas.exponent >= 1))
        refuse(object, "gas.exponent", short_text(gas.exponent), "a number >= 1");
    require_table(object, "gas.inflow", gas.inflow);
    return {.ambient = gas.ambient, .density = gas.density, .exponent = gas.exponent};
}

CavityFluid fluid_of(const std::string& object, const LiquidFilling& liquid) {
    require_above(object, "liquid.bulk_modulus", liquid.bulk_modulus, 0, " (Pa)");
    if (!(std::isfinite(liquid.ambient) && liquid.ambient >= 0))
        refuse(object, "liquid.ambient", short_text(liquid.ambient), "a number >= 0 (Pa)");
    if (liquid.volume) require_keys(object, "liquid.volume", *liquid.volume, 0, " (m^3)");
    return {.ambient = liquid.ambient, .bulk_modulus = liquid.bulk_modulus};
}

CavityInputs cavities_of(const Model& model) {
    return CavityInputs::bind({}, model.cavities, model.bodies, model.nodes);
}

/// Present volume of a cavity [m^3]; 0 for an open cavity with a given pressure, whose volume is not defined.
Real volume_of_cavity(const Model& model, std::size_t row) {
    const bool known = model.cavities.closed[row] || model.cavities.law[row] != CavityLaw::pressure;
    return known ? cavities_of(model).volume(row) : 0;
}

CavityFilling filling_of(const Model& model, std::size_t row, Real time) {
    return cavities_of(model).filling(row, time, volume_of_cavity(model, row));
}

void erase_cavity(Model& model, std::size_t row) {
    std::vector<bool> removed(model.cavities.size(), false);
    removed[row] = true;
    erase_joining_rows(removed, model.cavities, model.cavity_map);
    model.links_open = true;
    note_forces(model);
}

}  // namespace

void renew_corners(Model& model, std::size_t body) {
    CavityTable& table = model.cavities;
    const CavityInputs cavities = cavities_of(model);
    for (std::size_t c = 0; c < table.size(); ++c) {
        if (table.body[c] != static_cast<Index>(body) || table.closed[c] || table.law[c] == CavityLaw::pressure)
            continue;
        for (auto f = static_cast<std::size_t>(table.faces[c].begin); f < static_cast<std::size_t>(table.faces[c].end);
             ++f)
            table.corners[f] = cavities.corners_now(c, f);
    }
}

CavityHandle Cavities::add(const CavitySettings& cavity) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("add");
    Model& model = state.model;
    const auto body = static_cast<std::size_t>(model.row(cavity.body, "add cavity"));
    const std::string object = title_of_cavity(model, body);
    const std::vector<Face> faces = chosen_faces(model, body, object, cavity.faces);
    const auto edge = open_edge(faces);
    const bool closed = edge.first == no_index;
    const auto* const gas = std::get_if<GasFilling>(&cavity.filling);
    const auto* const liquid = std::get_if<LiquidFilling>(&cavity.filling);
    CavityFluid fluid;
    if (gas) fluid = fluid_of(object, *gas);
    if (liquid) fluid = fluid_of(object, *liquid);
    if (!gas && !liquid) require_table(object, "pressure", std::get<TimeTable>(cavity.filling));
    if (cavity.volume) {
        require_above(object, "volume", *cavity.volume, 0, " (m^3)");
        if (closed || (!gas && !liquid))
            refuse(object, "volume", short_text(*cavity.volume),
                   closed ? "no volume, because it follows from the faces"
                          : "no volume, because only a gas or a liquid has one");
    } else if (!closed && (gas || liquid)) {
        refuse(object, "faces",
               "an open edge between the nodes " + std::to_string(edge.first) + " and " + std::to_string(edge.second),
               "faces that enclose a volume, or the volume at the start in `volume`");
    }

    CavityTable& table = model.cavities;
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const CavityHandle handle = model.cavity_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    table.body[row] = static_cast<Index>(body);
    table.law[row] = gas ? CavityLaw::gas : liquid ? CavityLaw::liquid : CavityLaw::pressure;
    table.closed[row] = closed;
    table.fluid[row] = fluid;
    table.volume[row] = cavity.volume.value_or(0);
    table.mass[row] = table.pressure_now[row] = table.power[row] = table.volume_now[row] = 0;
    table.keys[row] = {};
    const auto begin = static_cast<Index>(table.face.size());
    for (const Face& face : faces) {
        table.face.push_back(face);
        table.corners.push_back(Mat3::Zero());
    }
    table.faces[row] = {begin, static_cast<Index>(table.face.size())};
    renew_corners(model, body);
    const Real volume = volume_of_cavity(model, row);
    const TimeTable& keys = gas      ? gas->inflow
                            : liquid ? liquid->volume.value_or(TimeTable(volume))
                                     : std::get<TimeTable>(cavity.filling);
    set_keys(table.keys, table.key, row, keys.keys);
    if ((gas || liquid) && !(volume > 0)) {
        erase_cavity(model, row);
        refuse(object, "faces", "faces around " + short_text(volume) + " m^3",
               "faces that bound a volume > 0; the normals that point out of the body must point into the cavity");
    }
    if (gas) table.mass[row] = mass_of_gas(fluid, gas->pressure, volume);
    table.pressure_now[row] = filling_of(model, row, state.clock.time).pressure();
    model.wake(body);
    model.links_open = true;
    note_forces(model);
    state.record.balance.close();  // the energy of the filling appears with the cavity
    return handle;
}

void prepare_removal(World& world, CavityHandle cavity) {
    Model& model = WorldAccess::state_of(world).model;
    std::vector<bool> removed(model.pipes.size(), false);
    for (std::size_t p = 0; p < removed.size(); ++p)
        removed[p] = model.pipes.first[p] == cavity.slot || model.pipes.second[p] == cavity.slot;
    wake_and_erase_rows(removed, model.pipes, model.pipe_map, model);
}

CavityState Cavities::state(CavityHandle cavity) const {
    return cavity_state(WorldAccess::state_of(*world_), cavity);
}

CavitySettings Cavities::settings(CavityHandle cavity) const {
    const WorldState& world = WorldAccess::state_of(*world_);
    const Model& model = world.model;
    const CavityTable& table = model.cavities;
    const auto row = static_cast<std::size_t>(model.row(cavity, "settings"));
    const CavityFluid& fluid = table.fluid[row];
    const TimeTable values = time_table_of(table.keys_of(row));
    const std::span<const Face> faces = rows_of(table.face.span(), table.faces[row]);
    CavitySettings settings{.body = handle_of_body(model, table.body[row]),
                            .faces = std::vector<Face>(faces.begin(), faces.end()),
                            .filling = values};
    if (table.law[row] == CavityLaw::gas)
        settings.filling = GasFilling{.pressure = filling_of(model, row, world.clock.time).pressure(),
                                      .exponent = fluid.exponent,
                                      .ambient = fluid.ambient,
                                      .density = fluid.density,
                                      .inflow = values};
    if (table.law[row] == CavityLaw::liquid)
        settings.filling =
            LiquidFilling{.bulk_modulus = fluid.bulk_modulus, .volume = values, .ambient = fluid.ambient};
    if (!table.closed[row] && table.law[row] != CavityLaw::pressure) settings.volume = volume_of_cavity(model, row);
    return settings;
}

CavityState cavity_state(const WorldState& world, CavityHandle cavity) {
    const Model& model = world.model;
    const CavityTable& table = model.cavities;
    const auto row = static_cast<std::size_t>(model.row(cavity, "cavity"));
    const CavityFilling filling = filling_of(model, row, world.clock.time);
    CavityState now;
    now.body = handle_of_body(model, table.body[row]);
    now.law = table.law[row];
    now.faces = table.faces[row].size();
    now.closed = table.closed[row] != 0;
    now.pressure = filling.pressure();
    now.volume = std::max(filling.volume, Real(0));  // filling.volume is < 0 if the faces enclose the body itself
    now.mass = table.mass[row];
    now.energy = filling.energy();
    const CavityInputs cavities = cavities_of(model);
    for (auto f = static_cast<std::size_t>(table.faces[row].begin); f < static_cast<std::size_t>(table.faces[row].end);
         ++f)
        now.force -= now.pressure * area_of(cavities.corners_now(row, f));
    return now;
}

namespace {

/// Replaces the keys of a table row by those of `values`. Returns false if the row already has these keys.
template <class Table>
bool replace_keys(Table& table, std::size_t row, const TimeTable& values) {
    if (std::ranges::equal(table.keys_of(row), values.keys)) return false;
    set_keys(table.keys, table.key, row, values.keys);
    return true;
}

std::size_t row_with_law(const Model& model, CavityHandle cavity, CavityLaw law, const char* call) {
    const auto row = static_cast<std::size_t>(model.row(cavity, call));
    if (const CavityLaw found = model.cavities.law[row]; found != law)
        refuse(title_of_row(model, row), call, "a cavity with the law " + std::string(name_of(found)),
               "a cavity with the law " + std::string(name_of(law)));
    return row;
}

/// Replaces the keys of a cavity by those of `values`, and wakes its body. Returns false if the cavity already has
/// these keys.
bool replace_keys_of_cavity(Model& model, std::size_t row, const TimeTable& values) {
    if (!replace_keys(model.cavities, row, values)) return false;
    model.wake(static_cast<std::size_t>(model.cavities.body[row]));
    note_forces(model);
    return true;
}

void wake_ends(Model& model, std::size_t pipe) {
    for (const Index body : {model.pipes.first_body[pipe], model.pipes.second_body[pipe]})
        if (body != no_index) model.wake(static_cast<std::size_t>(body));
}

/// Title of a pipe. `first`, `second`: rows of its cavities; equal rows mark a pipe from a cavity to a reservoir.
std::string title_of_pipe(const Model& model, std::size_t first, std::size_t second) {
    return "pipe between the " + title_of_row(model, first) + " and " +
           (first == second ? "a reservoir" : "the " + title_of_row(model, second));
}

std::string title_of_pipe(const Model& model, std::size_t pipe) {
    const auto row_of_slot = [&](std::uint32_t slot) {
        return static_cast<std::size_t>(model.cavity_map.row(model.cavity_map.handle_of_slot(slot)));
    };
    return title_of_pipe(model, row_of_slot(model.pipes.first[pipe]), row_of_slot(model.pipes.second[pipe]));
}

void require_conductance(const std::string& object, Real conductance) {
    if (!(std::isfinite(conductance) && conductance >= 0))
        refuse(object, "conductance", short_text(conductance), "a number >= 0 (kg/(s Pa))");
}

/// Throws SceneError if a cavity at the end of a pipe contains no gas. `field`: name of the end, for the message.
void require_gas(const Model& model, const std::string& object, std::size_t cavity, const char* field) {
    if (const CavityLaw law = model.cavities.law[cavity]; law != CavityLaw::gas)
        refuse(object, field, "a cavity with the law " + std::string(name_of(law)), "a cavity with a gas");
}

}  // namespace

void Cavities::set_pressure(CavityHandle cavity, const TimeTable& pressure) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_pressure");
    const std::size_t row = row_with_law(state.model, cavity, CavityLaw::pressure, "set_pressure");
    require_table(title_of_row(state.model, row), "pressure", pressure);
    replace_keys_of_cavity(state.model, row, pressure);
}

void Cavities::set_inflow(CavityHandle cavity, const TimeTable& inflow) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_inflow");
    const std::size_t row = row_with_law(state.model, cavity, CavityLaw::gas, "set_inflow");
    require_table(title_of_row(state.model, row), "inflow", inflow);
    replace_keys_of_cavity(state.model, row, inflow);
}

void Cavities::set_liquid_volume(CavityHandle cavity, const TimeTable& volume) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_liquid_volume");
    const std::size_t row = row_with_law(state.model, cavity, CavityLaw::liquid, "set_liquid_volume");
    require_keys(title_of_row(state.model, row), "volume", volume, 0, " (m^3)");
    // The energy of the liquid jumps with its volume.
    if (replace_keys_of_cavity(state.model, row, volume)) state.record.balance.close();
}

PipeHandle Cavities::add(const PipeSettings& pipe) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("add");
    Model& model = state.model;
    const auto first = static_cast<std::size_t>(model.row(pipe.first, "add pipe"));
    const auto second = static_cast<std::size_t>(model.row(pipe.second.value_or(pipe.first), "add pipe"));
    const std::string object = title_of_pipe(model, first, second);
    require_gas(model, object, first, "first");
    require_gas(model, object, second, "second");
    require_conductance(object, pipe.conductance);
    require_table(object, "pressure", pipe.pressure);
    if (pipe.second && first == second)
        refuse(object, "second", "the first cavity", "another cavity, or none for a reservoir");
    if (pipe.second && pipe.pressure != TimeTable())
        refuse(object, "pressure", "a pressure of a reservoir", "no pressure for a pipe between two cavities");
    if (model.cavities.fluid[first] != model.cavities.fluid[second])
        refuse(object, "second", "a cavity whose gas has another exponent, density or ambient pressure",
               "a cavity with the gas of the first cavity");
    for (const TimeKey& key : pipe.pressure.keys)
        require_above(object, "pressure", key.value, -model.cavities.fluid[first].ambient, " (Pa), which is vacuum");
    PipeTable& table = model.pipes;
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const PipeHandle handle = model.pipe_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    table.first[row] = pipe.first.slot;
    table.second[row] = pipe.second.value_or(pipe.first).slot;
    table.first_body[row] = model.cavities.body[first];
    table.second_body[row] = pipe.second ? model.cavities.body[second] : no_index;
    table.conductance[row] = pipe.conductance;
    table.flow[row] = 0;
    table.keys[row] = {};
    if (!pipe.second) set_keys(table.keys, table.key, row, pipe.pressure.keys);
    wake_ends(model, row);
    model.links_open = true;
    return handle;
}

PipeSettings Cavities::settings(PipeHandle pipe) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const auto row = static_cast<std::size_t>(model.row(pipe, "settings"));
    PipeSettings settings{.first = model.cavity_map.handle_of_slot(model.pipes.first[row]),
                          .conductance = model.pipes.conductance[row]};
    if (model.pipes.keys[row].size() == 0)
        settings.second = model.cavity_map.handle_of_slot(model.pipes.second[row]);
    else
        settings.pressure = time_table_of(model.pipes.keys_of(row));
    return settings;
}

PipeState Cavities::state(PipeHandle pipe) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const auto row = static_cast<std::size_t>(model.row(pipe, "pipe"));
    PipeState now;
    now.first = model.cavity_map.handle_of_slot(model.pipes.first[row]);
    if (model.pipes.keys[row].size() == 0) now.second = model.cavity_map.handle_of_slot(model.pipes.second[row]);
    now.conductance = model.pipes.conductance[row];
    now.flow = model.pipes.flow[row];
    return now;
}

void Cavities::set_conductance(PipeHandle pipe, Real conductance) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_conductance");
    const auto row = static_cast<std::size_t>(state.model.row(pipe, "set_conductance"));
    require_conductance(title_of_pipe(state.model, row), conductance);
    if (state.model.pipes.conductance[row] == conductance) return;
    state.model.pipes.conductance[row] = conductance;
    wake_ends(state.model, row);
}

void Cavities::set_reservoir(PipeHandle pipe, const TimeTable& pressure) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_reservoir");
    Model& model = state.model;
    const auto row = static_cast<std::size_t>(model.row(pipe, "set_reservoir"));
    const std::string object = title_of_pipe(model, row);
    if (model.pipes.keys[row].size() == 0)
        refuse(object, "set_reservoir", "a pipe between two cavities", "a pipe with a reservoir");
    require_table(object, "pressure", pressure);
    const auto first =
        static_cast<std::size_t>(model.cavity_map.row(model.cavity_map.handle_of_slot(model.pipes.first[row])));
    for (const TimeKey& key : pressure.keys)
        require_above(object, "pressure", key.value, -model.cavities.fluid[first].ambient, " (Pa), which is vacuum");
    if (replace_keys(model.pipes, row, pressure)) wake_ends(model, row);
}

}  // namespace skerry
