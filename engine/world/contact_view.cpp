#include "engine/world/contact_view.h"

#include "systems/contact/keep_resting_contacts.h"

namespace skerry {

namespace {

bool deforms(const Model& model, Index body) {
    return body != no_index && model.bodies.kind[static_cast<std::size_t>(body)] == BodyKind::deformable;
}

BodyHandle body_handle(const Model& model, Index body) {
    return deforms(model, body) ? model.body_map.handle_of_slot(model.bodies.slot[static_cast<std::size_t>(body)])
                                : BodyHandle{};
}

ColliderHandle collider_handle(const Model& model, const ContactTable& table, std::size_t c) {
    Index collider = table.collider[c];
    for (Index body : {table.first_body[c], table.second_body[c]})
        if (body != no_index && !deforms(model, body)) collider = model.bodies.collider[static_cast<std::size_t>(body)];
    if (collider == no_index) return {};
    return model.collider_map.handle_of_slot(model.colliders.slot[static_cast<std::size_t>(collider)]);
}

Index local_node(const Model& model, Index node) {
    const Index body = model.nodes.body[static_cast<std::size_t>(node)];
    return node - model.bodies.nodes[static_cast<std::size_t>(body)].begin;
}

/// True for explicit and rigid bodies. Contact forces act on them for StepParameters::kick_time. On implicit bodies
/// they act for the length of the step.
bool acts_for_force_time(const Model& model, Index body) {
    return deforms(model, body) && model.bodies.implicit[static_cast<std::size_t>(body)].size() == 0;
}

Contact contact_at(const Model& model, const ContactTable& table, std::size_t c) {
    Contact contact;
    contact.first = body_handle(model, table.first_body[c]);
    contact.second = body_handle(model, table.second_body[c]);
    contact.collider = collider_handle(model, table, c);
    for (std::size_t a = 0; a < 4; ++a) {
        contact.weight[a] = table.stencil[c].weight[a];
        contact.node[a] = contact.weight[a] == 0 ? -1 : local_node(model, table.stencil[c].node[a]);
    }
    contact.point = table.point[c];
    contact.normal = table.normal[c];
    contact.distance = table.distance[c];
    contact.gap = table.gap[c];
    const FrictionAxis& axis = table.friction_axis[c];
    contact.static_friction = table.static_friction[c];
    contact.dynamic_friction = table.dynamic_friction[c];
    contact.friction_across = axis.across * table.dynamic_friction[c];
    if (axis.across != 1) contact.friction_direction = axis.direction;
    contact.slip = table.slip[c];
    contact.impulse = table.impulse[c];
    contact.motion = static_cast<ContactMotion>(table.state[c]);
    contact.region = table.region[c];
    return contact;
}

}  // namespace

void view_contacts(WorldState& world) {
    RunRecord& record = world.record;
    if (record.contact_view_is_current) return;
    const ContactTable& of_step = world.scratch.contacts;
    const RestingContactTable& resting = world.cache.resting;
    Column<Index>& rows = record.contact_rows;
    merge_contacts(of_step, resting, rows);
    record.contact_view.resize(rows.size());
    const Real kick_time = world.scratch.parameters.kick_time, step_time = world.clock.step_before;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool rests = rows[i] < 0;
        const ContactTable& table = rests ? resting.contact : of_step;
        const auto row = static_cast<std::size_t>(rests ? ~rows[i] : rows[i]);
        Contact& contact = record.contact_view[i] = contact_at(world.model, table, row);
        if (rests) contact.impulse *= kick_time / resting.step[row];
        const bool for_force_time = rests || acts_for_force_time(world.model, table.first_body[row]) ||
                                    acts_for_force_time(world.model, table.second_body[row]);
        contact.seconds = for_force_time ? kick_time : step_time;
    }
    record.contact_view_is_current = true;
}

std::span<const Contact> World::contacts() const {
    WorldState& world = *state_;
    world.settle();
    // After a step that could not be completed, the contacts may contain NaN or infinity.
    if (world.scratch.findings.verdict.fault != StepFault::none) return {};
    view_contacts(world);
    return world.record.contact_view;
}

}  // namespace skerry
