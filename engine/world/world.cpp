#include "skerry/world.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <ostream>
#include <random>
#include <utility>

#include "engine/world/contact_view.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/material_row.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Rows of the materials of the tetrahedra; empty where none is named by its label.
std::vector<Index> materials_of_tetrahedra(const Model& model, const Mesh& mesh, const BodySettings& body) {
    if (body.materials.empty()) return {};
    std::map<int, Index> row_of;
    for (const auto& [label, material] : body.materials) row_of[label] = model.row(material, "add_body");
    std::vector<Index> rows(mesh.tetrahedra.size(), model.row(body.material, "add_body"));
    for (std::size_t t = 0; t < rows.size(); ++t)
        if (const auto named = row_of.find(mesh.label[t]); named != row_of.end()) rows[t] = named->second;
    return rows;
}

/// A mesh is a body, too; other colliders have no nodes.
EditedRows rows_of(const Shape& shape) {
    return std::holds_alternative<SurfaceMesh>(shape) ? EditedRows::bodies : EditedRows::colliders;
}

/// Of no two worlds of this process the same, and hardly the same as that of a world that another process saved.
std::uint32_t next_world_number() {
    static std::atomic<std::uint32_t> next = std::random_device{}();
    const std::uint32_t number = next++;
    return number != 0 ? number : next++;  // 0: no world
}

}  // namespace

WorldState::WorldState(const Settings& settings) : executor(make_executor(settings.backend, settings.threads)) {
    model.set_world(next_world_number());
    model.settings = settings;
    model.settings.backend = executor->backend();
    scratch.parameters = step_parameters(settings);
    graph.track(this, sizeof *this, name_of_column);
    build_step(*this);
}

void WorldState::require_between_steps(const char* call) const {
    if (!advancing) return;
    Complaint{.file = {},
              .object = call,
              .field = {},
              .found = "a call in the middle of advance",
              .expected = "one between two calls of it",
              .hint = "what advance calls back may look at the world, and not build, remove or advance"}
        .raise();
}

void WorldState::begin_edit(const char* call) {
    require_between_steps(call);
    view_contacts(*this);  // while rows are where contacts say
}

void WorldState::end_edit(EditedRows rows) {
    edited_ = std::max(edited_, rows);
}

void WorldState::settle() {
    if (edited_ == EditedRows::none) return;
    query_trees.forget();
    if (edited_ == EditedRows::bodies) {
        model.rebuild_derived();
        model.clusters.clear();  // of rows that have moved
        model.clusters_open = true;
    }
    model.wake_all();
    cache.drop_pairs(model);
    record.balance.close();
    scratch.contacts.resize(0);
    scratch.regions = RegionTable{};
    edited_ = EditedRows::none;
}

World::StateOwner::StateOwner(std::unique_ptr<WorldState> owned) : owned_(std::move(owned)) {}
World::StateOwner::~StateOwner() = default;
World::StateOwner::StateOwner(StateOwner&&) noexcept = default;
World::StateOwner& World::StateOwner::operator=(StateOwner&&) noexcept = default;

WorldState& World::StateOwner::operator*() const {
    if (!owned_)
        Complaint{.file = {},
                  .object = "world",
                  .field = {},
                  .found = "one that was moved from",
                  .expected = "a world",
                  .hint = "use the one that it was moved to"}
            .raise();
    return *owned_;
}

World::World(const Settings& settings) : state_((validate(settings), std::make_unique<WorldState>(settings))) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

World World::clone() const {
    WorldState& from = *state_;
    from.require_between_steps("clone");
    from.settle();
    World copy(from.model.settings);
    WorldState& to = *copy.state_;
    to.model = from.model;
    to.clock = from.clock;
    to.cache = from.cache;
    to.scratch.parameters = from.scratch.parameters;
    to.scratch.findings = from.scratch.findings;
    to.scratch.contacts = from.scratch.contacts;
    to.record.counters = from.record.counters;
    to.record.limits = from.record.limits;
    to.record.balance = from.record.balance;
    to.record.start_overlaps = from.record.start_overlaps;
    to.record.start_moves = from.record.start_moves;
    to.record.forces = from.record.forces;
    to.record.contact_view = from.record.contact_view;
    to.record.contact_view_is_current = from.record.contact_view_is_current;
    return copy;
}

MaterialHandle World::add_material(const MaterialSettings& material) {
    state_->require_between_steps("add_material");
    validate(material, state_->model.settings);
    MaterialTable& table = state_->model.materials;
    const std::size_t row = table.slot.size();
    table.for_each_column([row](const char*, auto& column, ColumnRole) { column.resize(row + 1); });
    MaterialRow::of(material).write(table, row);
    const MaterialHandle handle = state_->model.material_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    return handle;
}

BodyHandle World::add_body(const Mesh& mesh, const BodySettings& body) {
    validate(mesh, body);
    const Index material = state_->model.row(body.material, "add_body");
    const std::vector<Index> tetrahedron_material = materials_of_tetrahedra(state_->model, mesh, body);
    state_->begin_edit("add_body");
    const BodyHandle handle = state_->model.body_map.insert(static_cast<Index>(state_->model.bodies.slot.size()));
    append_body(state_->model, state_->scratch.stiffness_sum,
                {.slot = handle.slot,
                 .kind = BodyKind::deformable,
                 .self_contact = body.self_contact,
                 .filter = {body.collision_group, body.collision_mask},
                 .element = body.element,
                 .material = material,
                 .tetrahedron_material = tetrahedron_material,
                 .collider = no_index,
                 .contact_distance = body.contact_distance.value_or(-1),
                 .nodes = mesh.nodes,
                 .tetrahedra = mesh.tetrahedra,
                 .triangles = {},
                 .position = body.position,
                 .rotation = rotation_matrix(body.rotation),
                 .velocity = body.velocity,
                 .angular_velocity = body.angular_velocity});
    const std::string name = body.name.empty() ? "body " + std::to_string(handle.slot) : body.name;
    state_->model.body_records.back().name = name;
    try {
        validate_step(state_->model, state_->model.row(handle, "add_body"), name);
    } catch (const SceneError&) {
        erase_body(state_->model, state_->model.row(handle, "add_body"));
        state_->model.body_map.erase(handle);
        throw;
    }
    state_->end_edit(EditedRows::bodies);
    return handle;
}

ColliderHandle World::add_collider(const Shape& shape, const ColliderSettings& collider) {
    validate(shape, collider);
    state_->begin_edit("add_collider");
    const ColliderHandle handle =
        state_->model.collider_map.insert(static_cast<Index>(state_->model.colliders.slot.size()));
    append_collider(state_->model, state_->scratch.stiffness_sum, handle.slot, shape, collider, state_->clock.time);
    std::string& name = state_->model.collider_records.back().name;
    if (name.empty()) name = "collider " + std::to_string(handle.slot);
    state_->end_edit(rows_of(shape));
    return handle;
}

AttachmentHandle World::attach(BodyHandle body, std::span<const Index> nodes, const Motion& motion, const Vec3& pivot) {
    const Index row = state_->model.row(body, "attach");
    validate(motion, pivot);
    const Index count = state_->model.bodies.nodes[static_cast<std::size_t>(row)].size();
    for (Index node : nodes)
        if (node < 0 || node >= count)
            Complaint{.file = {},
                      .object = "attach",
                      .field = "nodes",
                      .found = "node " + std::to_string(node),
                      .expected = "nodes of the body, 0 to " + std::to_string(count - 1),
                      .hint = {}}
                .raise();
    state_->begin_edit("attach");
    const AttachmentHandle handle =
        state_->model.attachment_map.insert(static_cast<Index>(state_->model.attachments.slot.size()));
    append_attachment(state_->model, handle.slot, row, nodes, {pivot, Mat3::Identity()}, motion, state_->clock.time);
    state_->end_edit(EditedRows::bodies);
    return handle;
}

void World::remove(BodyHandle body) {
    const Index row = state_->model.row(body, "remove");
    state_->begin_edit("remove");
    forget_contacts_of(body, state_->record);
    ForceLedger& forces = state_->record.forces;
    forces.forget_body(body.slot);
    for (std::size_t a = 0; a < state_->model.attachments.slot.size(); ++a)
        if (state_->model.attachments.body[a] == row) forces.forget_attachment(state_->model.attachments.slot[a]);
    enable_pairs_of(body, state_->model.disabled_pairs);
    erase_body(state_->model, row);
    state_->model.body_map.erase(body);
    state_->end_edit(EditedRows::bodies);
}

void World::remove(ColliderHandle collider) {
    const Index row = state_->model.row(collider, "remove");
    state_->begin_edit("remove");
    forget_contacts_of(collider, state_->record);
    state_->record.forces.forget_collider(collider.slot);
    enable_pairs_of(collider, state_->model.disabled_pairs);
    const EditedRows rows = rows_of(state_->model.collider_records[static_cast<std::size_t>(row)].shape);
    erase_collider(state_->model, row);
    state_->model.collider_map.erase(collider);
    state_->end_edit(rows);
}

void World::remove(AttachmentHandle attachment) {
    const Index row = state_->model.row(attachment, "remove");
    state_->begin_edit("remove");
    state_->record.forces.forget_attachment(attachment.slot);
    erase_attachment(state_->model, row);
    state_->model.attachment_map.erase(attachment);
    state_->end_edit(EditedRows::bodies);
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
    state_->scratch.parameters = step_parameters(state_->model.settings);
    state_->record.balance.close();
    state_->model.wake_all();
}

Real World::stable_step() const {
    state_->settle();
    settle_clusters(state_->model, state_->scratch.stiffness_sum);
    return skerry::stable_step(state_->model.bodies);
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
