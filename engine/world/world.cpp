#include "skerry/world.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <numeric>
#include <ostream>
#include <random>
#include <string_view>
#include <utility>

#include "components/any_table.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/erase_gone.h"
#include "engine/world/edit/joining_rows.h"
#include "engine/world/edit/material_row.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/step/step.h"
#include "engine/world/tuning.h"
#include "engine/world/validate.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/dynamics/rigid/move_rigid_bodies.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Returns for each tetrahedron the row of its material in MaterialTable. The result is empty if no label or set has a
/// material of its own.
std::vector<Index> materials_of_tetrahedra(const Model& model, const Mesh& mesh, const BodySettings& body) {
    if (body.materials.empty() && body.materials_of_sets.empty()) return {};
    std::map<int, Index> row_of;
    for (const auto& [label, material] : body.materials) row_of[label] = model.row(material, "add_body");
    std::vector<Index> rows(mesh.tetrahedra.size(), model.row(body.material, "add_body"));
    for (std::size_t t = 0; t < rows.size() && !row_of.empty(); ++t)
        if (const auto named = row_of.find(mesh.label[t]); named != row_of.end()) rows[t] = named->second;
    for (const auto& [name, material] : body.materials_of_sets)
        for (const Index t : mesh::tetrahedra_of(mesh.sets.at(name), mesh.tetrahedra))
            rows[static_cast<std::size_t>(t)] = model.row(material, "add_body");
    return rows;
}

void mark(Index row, std::vector<std::uint8_t>& rows) {
    const auto at = static_cast<std::size_t>(row);
    if (rows.size() <= at) rows.resize(at + 1, 0);
    rows[at] = 1;
}

/// Returns a number that no other world of this process has. The random start makes it most probable that no world
/// saved by another process has it either.
std::uint32_t next_world_number() {
    static std::atomic<std::uint32_t> next = std::random_device{}();
    const std::uint32_t number = next++;
    return number != 0 ? number : next++;  // 0 means no world
}

}  // namespace

WorldState::WorldState(const Settings& settings) : executor(make_executor(settings.backend, settings.threads)) {
    model.set_world(next_world_number());
    model.settings = settings;
    model.settings.backend = executor->backend();
    scratch.parameters = step_parameters(settings, model.tuning);
    graph.track(this, sizeof *this, name_of_column);
    build_step(*this);
}

void WorldState::require_between_steps(const char* call) const {
    // calls that are allowed in a world divided among ranks; all ranks must make them together
    constexpr std::array<std::string_view, 4> on_ranks{"advance", "distribute", "settle_start", "watch_steps"};
    if (ranks.on() && std::ranges::find(on_ranks, call) == on_ranks.end())
        refuse(call, "world", "a world that is divided among ranks", "an undivided world",
               "call it before distribute(), or with the world that gathered() returns");
    if (!advancing) return;
    refuse(call, {}, "a call during advance() or rollout()", "a call after their end",
           "a callback that they run may read the world but must not change or advance it");
}

void WorldState::draw(bool resting) {
    if (!drawn_behind) return;
    drawn_behind = false;
    draw_round_bodies(
        *executor, RigidBodies::bind({}, model.rigid_bodies, model.bodies, model.nodes, model.any_asleep, model.forced),
        resting, model.nodes.position, model.nodes.velocity);
}

void WorldState::settle() {
    draw();
    if (!edits.places.empty()) edits.places.wake_near(model);
    model.known_elements.clear();
    if (!edits.rows) return;
    if (edits.elements) {
        model.clusters.clear();  // a cluster is a set of rows of NodeTable, which erase_gone_rows moves
        model.clusters_open = true;
    }
    erase_gone_rows();
    model.extend_derived();
    find_holding_attachments(model);
    note_forces(model);
    model.links_open = true;
    cache.extend(model);
    query_trees.forget();
    record.balance.close();
    edits.rows = edits.elements = false;
}

void WorldState::erase_gone_rows() {
    const RowMoves moves = row_moves(model, edits.removed_bodies, edits.removed_colliders);
    edits.removed_bodies.clear();
    edits.removed_colliders.clear();
    if (!moves.any()) return;
    erase_gone(moves, model.nodes.body, cache);
    erase_gone(moves, model.nodes.body, scratch.contacts);
    scratch.regions = RegionTable{};
    record.contact_view_is_current = false;
    erase_gone(moves, model);
}

World::StateOwner::StateOwner(std::unique_ptr<WorldState> owned) : owned_(std::move(owned)) {}
World::StateOwner::~StateOwner() = default;
World::StateOwner::StateOwner(StateOwner&&) noexcept = default;
World::StateOwner& World::StateOwner::operator=(StateOwner&&) noexcept = default;

WorldState& World::StateOwner::operator*() const {
    if (!owned_)
        refuse("world", {}, "a moved-from world", "a valid world",
               "use the world to which the content of this world was moved");
    return *owned_;
}

World::World(const Settings& settings) : state_((validate(settings), std::make_unique<WorldState>(settings))) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

void use(const LoadSettings& load_settings, Settings& settings) {
    settings.backend = load_settings.backend.value_or(settings.backend);
    settings.threads = load_settings.threads.value_or(settings.threads);
    validate(settings);
}

World tuned_world(const Settings& settings, const Tuning& tuning) {
    validate(tuning);
    World world(settings);
    WorldState& state = WorldAccess::state_of(world);
    state.model.tuning = tuning;
    state.scratch.parameters = step_parameters(settings, tuning);
    return world;
}

World World::clone(const LoadSettings& settings) const {
    state_->require_between_steps("clone");
    state_->settle();
    return copy_of_settled(*state_, settings);
}

World copy_of_settled(const WorldState& source, const LoadSettings& load_settings) {
    Settings settings = source.model.settings;
    use(load_settings, settings);
    World copy = tuned_world(settings, source.model.tuning);
    WorldState& to = WorldAccess::state_of(copy);
    settings.backend = to.model.settings.backend;  // tuned_world() has replaced `automatic` by the backend in use
    to.model = source.model;
    to.model.settings = settings;
    to.clock = source.clock;
    to.cache = source.cache;
    to.scratch.parameters = source.scratch.parameters;
    to.scratch.findings = source.scratch.findings;
    to.scratch.contacts = source.scratch.contacts;
    to.record.counters = source.record.counters;
    to.record.limits = source.record.limits;
    to.record.self_crossings = source.record.self_crossings;
    to.record.balance = source.record.balance;
    to.record.held = source.record.held;
    to.record.start_overlaps = source.record.start_overlaps;
    to.record.start_moves = source.record.start_moves;
    to.record.forces = source.record.forces;
    to.record.contact_view = source.record.contact_view;
    to.record.contact_view_is_current = source.record.contact_view_is_current;
    return copy;
}

MaterialHandle World::add_material(const MaterialSettings& material) {
    state_->require_between_steps("add_material");
    validate(material);
    MaterialTable& table = state_->model.materials;
    const std::size_t row = table.slot.size();
    AnyTable(table).resize(row + 1);
    MaterialRow::of(material).write(table, row);
    const MaterialHandle handle = state_->model.material_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    return handle;
}

namespace {

/// Core of a round body (a rigid sphere, capsule or cylinder): its first nodes and a radius (BodyTable::core_nodes and
/// round_radius). Contacts use these instead of faces. The mesh of a round body is only drawn. A body with 0 core nodes
/// is not round.
struct RoundCore {
    Index nodes = 0;
    Real radius = 0;  // m
};

BodyHandle add_valid_body(WorldState& state, const Mesh& mesh, const BodySettings& body, const RoundCore& core = {}) {
    Model& model = state.model;
    const Index material = model.row(body.material, "add_body");
    const std::vector<Index> tetrahedron_material = materials_of_tetrahedra(model, mesh, body);
    state.require_between_steps("add_body");
    NewBody fresh{.slot = 0,
                  .kind = BodyKind::deformable,
                  .self_contact = body.self_contact,
                  .dynamics = body.dynamics,
                  .filter = {body.collision_group, body.collision_mask},
                  .element = body.element,
                  .material = material,
                  .tetrahedron_material = tetrahedron_material,
                  .collider = no_index,
                  .contact_distance = body.contact_distance.value_or(-1),
                  .core_nodes = core.nodes,
                  .round_radius = core.radius,
                  .nodes = mesh.nodes,
                  .tetrahedra = mesh.tetrahedra,
                  .triangles = mesh.triangles,
                  .position = body.position,
                  .rotation = rotation_matrix(body.rotation),
                  .velocity = body.velocity,
                  .angular_velocity = body.angular_velocity,
                  .mass = body.mass,
                  .center_of_mass = body.center_of_mass,
                  .inertia = body.inertia};
    DynamicsEstimate choice;
    std::optional<KnownElements> trial;
    if (core.nodes > 0) {
        fresh.dynamics = BodyDynamics::rigid;
    } else if (body.dynamics == BodyDynamics::automatic) {
        // Removed bodies must not limit the step that choose_dynamics estimates, so settle() erases them. Without
        // removed bodies settle() is not called, because it also discards Model::known_elements, which save time for
        // equal meshes.
        if (!state.edits.removed_bodies.empty()) state.settle();
        fresh.dynamics = BodyDynamics::explicit_elastic;
        fresh.dynamics = choose_dynamics(model, fresh, choice, trial);
    }
    if (fresh.dynamics == BodyDynamics::implicit_elastic)
        require_implicit_materials(model, material, tetrahedron_material, body.name);
    const BodyHandle handle = model.body_map.insert(static_cast<Index>(model.bodies.slot.size()));
    fresh.slot = handle.slot;
    append_body(model, state.scratch.stiffness_sum, fresh, trial ? &*trial : nullptr);
    if (trial) remember_elements(model, static_cast<Index>(model.body_records.size() - 1), std::move(*trial));
    model.body_records.back().choice = choice;
    model.body_records.back().label = mesh.label;
    model.body_records.back().sets = mesh.sets;
    const std::string name = body.name.empty() ? "body " + std::to_string(handle.slot) : body.name;
    model.body_records.back().name = name;
    try {
        validate_step(model, model.row(handle, "add_body"), name);
    } catch (const SceneError&) {
        std::vector<std::uint8_t> last;
        mark(model.row(handle, "add_body"), last);
        model.body_map.forget(handle);
        erase_gone(row_moves(model, last, {}), model);
        throw;
    }
    state.edits.rows = state.edits.elements = true;
    return handle;
}

/// Makes implicit bodies explicit if explicit steps cost less computing time, because the added body `added` requires
/// short steps anyway. Concerns only bodies for which the user has left the choice to the engine.
void revise_choices(World& world, WorldState& state, BodyHandle added) {
    Model& model = state.model;
    if (model.implicit_nodes.size() == 0 || model.has_frame(static_cast<std::size_t>(model.row(added, "add_body"))))
        return;
    if (!state.edits.removed_bodies.empty()) state.settle();
    DynamicsEstimate now;
    for (Index row = outdated_choice(model, now); row != no_index; row = outdated_choice(model, now)) {
        const BodyHandle body = model.body_map.handle_of_slot(model.bodies.slot[static_cast<std::size_t>(row)]);
        world.set_dynamics(body, BodyDynamics::explicit_elastic);
        model.body_records[static_cast<std::size_t>(model.row(body, "add_body"))].choice = now;
    }
}

}  // namespace

BodyHandle World::add_body(const Mesh& mesh, const BodySettings& body) {
    const Model& model = state_->model;
    validate(mesh, body, model.body_of_mesh(model.bodies.slot.size(), {mesh.tetrahedra, mesh.nodes}) != no_index);
    const BodyHandle added = add_valid_body(*state_, mesh, body);
    revise_choices(*this, *state_, added);
    return added;
}

BodyHandle World::add_body(const SurfaceMesh& surface, const BodySettings& body) {
    return add_body(Mesh{.nodes = surface.nodes, .tetrahedra = {}, .triangles = surface.triangles}, body);
}

BodyHandle World::add_body(const Sphere& sphere, const BodySettings& body) {
    validate(sphere, body);
    return add_valid_body(*state_, mesh::sphere_picture(sphere.radius), body, {1, sphere.radius});
}

BodyHandle World::add_body(const Capsule& capsule, const BodySettings& body) {
    validate(capsule, body);
    return add_valid_body(*state_, mesh::capsule_picture(capsule.radius, capsule.length), body, {2, capsule.radius});
}

BodyHandle World::add_body(const Cylinder& cylinder, const BodySettings& body) {
    validate(cylinder, body);
    const Real around = std::hypot(cylinder.radius, cylinder.height / 2);
    return add_valid_body(*state_, mesh::cylinder_picture(cylinder.radius, cylinder.height), body,
                          {cylinder_core_nodes, around});
}

ColliderHandle World::add_collider(const Shape& shape, const ColliderSettings& collider) {
    validate(shape, collider);
    state_->require_between_steps("add_collider");
    const ColliderHandle handle =
        state_->model.collider_map.insert(static_cast<Index>(state_->model.colliders.slot.size()));
    const Index row =
        append_collider(state_->model, state_->scratch.stiffness_sum, handle.slot, shape, collider, state_->clock.time);
    std::string& name = state_->model.collider_records.back().name;
    if (name.empty()) name = "collider " + std::to_string(handle.slot);
    state_->edits.places.add_collider(state_->model, static_cast<std::size_t>(row), time());
    state_->edits.rows = true;
    return handle;
}

namespace {

/// Must be called for an object that is removed. Resets HeldDepth::pair, the pair of surfaces with prescribed motion
/// that overlap deepest, if the object belongs to it. Otherwise a new object with the same slot would be reported by
/// mistake. The stored depth remains.
void forget_held(HeldDepth& held, std::uint32_t slot, bool is_collider) {
    const PairSlots pair = slots_of_pair(held.pair);
    if (is_collider ? pair.is_collider && pair.second == slot
                    : pair.first == slot || (!pair.is_collider && pair.second == slot))
        held.pair = HeldDepth::no_pair;
}

}  // namespace

void World::remove(BodyHandle body) {
    state_->require_between_steps("remove");
    Model& model = state_->model;
    const Index row = model.row(body, "remove");
    ForceLedger& forces = state_->record.forces;
    forces.forget_body(body.slot);
    forget_held(state_->record.held, body.slot, false);
    for (std::size_t a = 0; a < model.attachments.slot.size(); ++a) {
        const std::uint32_t slot = model.attachments.slot[a];
        if (model.attachments.body[a] != row || !model.attachment_map.has_slot(slot)) continue;
        forces.forget_attachment(slot);
        model.attachment_map.forget(model.attachment_map.handle_of_slot(slot));
    }
    enable_pairs_of(body, model.disabled_pairs);
    erase_rows_joining(ColumnRole::body, row, model);
    model.body_map.forget(body);
    OpenEdits& edits = state_->edits;
    edits.places.add_body(model, static_cast<std::size_t>(row));
    mark(row, edits.removed_bodies);
    edits.rows = edits.elements = true;
}

void World::remove(ColliderHandle collider) {
    state_->require_between_steps("remove");
    const Index row = state_->model.row(collider, "remove");
    state_->record.forces.forget_collider(collider.slot);
    forget_held(state_->record.held, collider.slot, true);
    enable_pairs_of(collider, state_->model.disabled_pairs);
    erase_rows_joining(ColumnRole::collider, row, state_->model);
    OpenEdits& edits = state_->edits;
    edits.places.add_collider(state_->model, static_cast<std::size_t>(row), time());
    mark(row, edits.removed_colliders);
    if (const Index body = state_->model.colliders.body[static_cast<std::size_t>(row)]; body != no_index)
        mark(body, edits.removed_bodies);
    state_->model.collider_map.forget(collider);
    edits.rows = true;
}

bool World::alive(BodyHandle body) const {
    return state_->model.body_map.row(body) != no_index;
}
bool World::alive(ColliderHandle collider) const {
    return state_->model.collider_map.row(collider) != no_index;
}
bool World::alive(AttachmentHandle attachment) const {
    return state_->model.attachment_map.row(attachment) != no_index;
}

Real World::time() const {
    return state_->clock.time;
}
const Settings& World::settings() const {
    return state_->model.settings;
}

void World::set_gravity(const Vec3& gravity) {
    state_->require_between_steps("set_gravity");
    if (gravity == state_->model.settings.gravity) return;
    Settings changed = state_->model.settings;
    changed.gravity = gravity;
    validate(changed);
    state_->model.settings.gravity = gravity;
    StepParameters& parameters = state_->scratch.parameters;
    const Real kick_time = parameters.kick_time;  // kept, because contacts of the last step are still reported with it
    parameters = step_parameters(state_->model.settings, state_->model.tuning);
    parameters.kick_time = kick_time;
    state_->record.balance.close();
    state_->model.wake_all();
}

Real World::stable_step() const {
    state_->settle();
    settle_clusters(state_->model, state_->scratch.stiffness_sum);
    return reported_step(state_->model);
}

void World::set_tracing(bool on) {
    state_->record.tracing = on;
}
void World::write_trace(std::ostream& out) const {
    state_->record.trace.write_json(out);
}
std::string World::step_graph() const {
    return state_->graph.to_dot();
}

}  // namespace skerry
