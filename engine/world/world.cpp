#include "skerry/world.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include "engine/world/world_state.h"
#include "systems/dynamics/element_energy.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_stale(const char* call, const char* kind) {
    Complaint{.file = {},
              .object = call,
              .field = kind,
              .found = "a handle to nothing",
              .expected = "one that lives in this world",
              .hint = "it was removed, or never made here"}
        .raise();
}

template <class Map, class HandleType>
Index live_row(const Map& map, HandleType handle, const char* call, const char* kind) {
    const Index row = map.row(handle);
    if (row == no_index) refuse_stale(call, kind);
    return row;
}

}  // namespace

WorldState::WorldState(const Settings& wanted) : settings(wanted), executor(make_executor(wanted.backend, wanted.threads)) {
    settings.backend = executor->backend();
    step.gravity = settings.gravity;
    step.contact_regions = settings.contact_regions;
    step.max_strain_step = settings.max_strain_step;
    step.sleep = {settings.sleep_speed, settings.sleep_time};
    step.collision.gravity = settings.gravity.norm();
    step.collision.use_budgets = settings.contact_budgets;
    // forward Euler drifts with velocities that no contact has seen: there is nothing to hold it to
    step.collision.continuous = settings.continuous_collision && settings.integrator != Integrator::literal;
    step.solver.method = settings.method;
    step.solver.friction = settings.friction;
    step.solver.warm_start = settings.warm_start;
    step.solver.tolerance = settings.tolerance;
    step.solver.max_iterations = settings.max_iterations;
    step.solver.fixed_iterations = settings.fixed_iterations;
    step.solver.relaxation = settings.relaxation;
    step.solver.restitution_speed = settings.restitution_speed;
    step.solver.recovery_speed = settings.recovery_speed;
    step.solver.certify_warm_start = settings.certify_warm_start;
    step.solver.skip_separating = settings.skip_separating;
    step.solver.frictionless_rows = settings.frictionless_rows;
    step.solver.freeze_contacts = settings.freeze_contacts;
    step.solver.small_regions_in_lanes = settings.small_regions_in_lanes;
    build_step(*this);
}

Index WorldState::row(BodyHandle body, const char* call) const {
    return live_row(body_map, body, call, "body");
}
Index WorldState::row(ColliderHandle collider, const char* call) const {
    return live_row(collider_map, collider, call, "collider");
}
Index WorldState::row(MaterialHandle material, const char* call) const {
    return live_row(material_map, material, call, "material");
}
Index WorldState::row(AttachmentHandle attachment, const char* call) const {
    return live_row(attachment_map, attachment, call, "attachment");
}

ElementInputs WorldState::element_inputs() const {
    return {elements.node,
            elements.inverse_rest,
            elements.volume,
            elements.material,
            materials.constants,
            elements.viscous_time,
            {elements.level, elements.body, bodies.level, step.due,
             any_asleep ? std::span<const std::uint8_t>(bodies.asleep.span()) : std::span<const std::uint8_t>()}};
}

RegionInputs WorldState::region_inputs(std::span<const Vec3> velocity) const {
    const ContactTable& c = contacts;
    return {c.stencil,
            c.normal,
            c.gap,
            c.surface_velocity,
            c.static_friction,
            c.dynamic_friction,
            c.restitution,
            nodes.inverse_mass,
            velocity,
            step.collision.gravity,
            c.key};
}

TouchInputs WorldState::touches() const {
    return {contacts.first_body, contacts.second_body, contacts.state, contacts.gap, contacts.surface_velocity};
}

RestingNodes WorldState::resting_nodes() const {
    if (!any_asleep) return {};
    return {nodes.body, bodies.asleep};
}

World::World(const Settings& settings) {
    validate(settings);
    state_ = std::make_unique<WorldState>(settings);
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

MaterialHandle World::add_material(const MaterialSettings& material) {
    validate(material, state_->settings);
    MaterialTable& table = state_->materials;
    const std::size_t row = table.slot.size();
    table.for_each_column([row](const char*, auto& column) { column.resize(row + 1); });
    const Real e = material.young_modulus, nu = material.poisson_ratio;
    table.constants[row] = {material.model, e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu)), material.density};
    const Real dynamic = material.dynamic_friction.value_or(material.friction);
    table.surface[row] = {material.static_friction.value_or(std::max(material.friction, dynamic)), dynamic, material.restitution};
    table.young_modulus[row] = e;
    table.poisson_ratio[row] = nu;
    table.damping[row] = material.damping;
    const MaterialHandle handle = state_->material_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    return handle;
}

BodyHandle World::add_body(const Mesh& mesh, const BodySettings& body) {
    validate(mesh, body);
    const Index material = state_->row(body.material, "add_body");
    const BodyHandle handle = state_->body_map.insert(static_cast<Index>(state_->bodies.slot.size()));
    append_body(*state_, {.slot = handle.slot,
                          .kind = BodyKind::deformable,
                          .self_contact = body.self_contact,
                          .material = material,
                          .collider = no_index,
                          .contact_distance = body.contact_distance.value_or(-1),
                          .nodes = mesh.nodes,
                          .tetrahedra = mesh.tetrahedra,
                          .triangles = {},
                          .position = body.position,
                          .rotation = rotation_matrix(body.rotation),
                          .velocity = body.velocity,
                          .angular_velocity = body.angular_velocity});
    state_->body_records.back().name = body.name.empty() ? "body " + std::to_string(handle.slot) : body.name;
    state_->topology_changed();
    return handle;
}

ColliderHandle World::add_collider(const Shape& shape, const ColliderSettings& collider) {
    validate(shape, collider);
    const ColliderHandle handle = state_->collider_map.insert(static_cast<Index>(state_->colliders.slot.size()));
    append_collider(*state_, handle.slot, shape, collider);
    std::string& name = state_->collider_records.back().name;
    if (name.empty()) name = "collider " + std::to_string(handle.slot);
    state_->topology_changed();
    return handle;
}

AttachmentHandle World::attach(BodyHandle body, std::span<const Index> nodes, const Motion& motion, const Vec3& pivot) {
    const Index row = state_->row(body, "attach");
    validate(motion, pivot);
    const Index count = state_->bodies.nodes[static_cast<std::size_t>(row)].size();
    for (Index node : nodes)
        if (node < 0 || node >= count)
            Complaint{.file = {},
                      .object = "attach",
                      .field = "nodes",
                      .found = "node " + std::to_string(node),
                      .expected = "nodes of the body, 0 to " + std::to_string(count - 1),
                      .hint = {}}
                .raise();
    const AttachmentHandle handle = state_->attachment_map.insert(static_cast<Index>(state_->attachments.slot.size()));
    append_attachment(*state_, handle.slot, row, nodes, {pivot, Mat3::Identity()}, motion);
    state_->topology_changed();
    return handle;
}

void World::remove(BodyHandle body) {
    const Index row = state_->row(body, "remove");
    erase_body(*state_, row);
    state_->body_map.erase(body);
    state_->topology_changed();
}

void World::remove(ColliderHandle collider) {
    const Index row = state_->row(collider, "remove");
    erase_collider(*state_, row);
    state_->collider_map.erase(collider);
    state_->topology_changed();
}

void World::remove(AttachmentHandle attachment) {
    const Index row = state_->row(attachment, "remove");
    erase_attachment(*state_, row);
    state_->attachment_map.erase(attachment);
    state_->topology_changed();
}

bool World::alive(BodyHandle body) const {
    return state_->body_map.row(body) != no_index;
}
bool World::alive(ColliderHandle collider) const {
    return state_->collider_map.row(collider) != no_index;
}
bool World::alive(AttachmentHandle attachment) const {
    return state_->attachment_map.row(attachment) != no_index;
}

Real World::time() const {
    return state_->step.time;
}
const Settings& World::settings() const {
    return state_->settings;
}

void World::set_gravity(const Vec3& gravity) {
    Settings changed = state_->settings;
    changed.gravity = gravity;
    validate(changed);
    state_->settings.gravity = state_->step.gravity = gravity;
    state_->step.collision.gravity = gravity.norm();
    state_->balance.close();
    state_->wake_all();
}

Real World::stable_step() const {
    return skerry::stable_step(*state_);
}

void World::set_tracing(bool on) {
    state_->tracing = on;
}
void World::write_trace(std::ostream& out) const {
    state_->trace.write_json(out);
}
std::string World::step_graph() const {
    return state_->graph.to_dot();
}

}  // namespace skerry
