// Writes rows of ContactTable.
#pragma once

#include <cstddef>

#include "components/contact_table.h"

namespace skerry {

/// Writes `row` to row c of the table. The contact belongs to no region yet; its impulse and slip are zero, and it is
/// open.
inline void write_contact(const ContactRow& row, std::size_t c, ContactTable& contacts) {
    contacts.key[c] = row.key;
    contacts.kind[c] = row.kind;
    contacts.stencil[c] = row.stencil;
    contacts.point[c] = row.point;
    contacts.normal[c] = row.normal;
    contacts.gap[c] = row.gap;
    contacts.distance[c] = row.distance;
    contacts.surface_velocity[c] = row.surface_velocity;
    contacts.static_friction[c] = row.static_friction;
    contacts.dynamic_friction[c] = row.dynamic_friction;
    contacts.restitution[c] = row.restitution;
    contacts.friction_axis[c] = {};
    contacts.first_body[c] = row.first_body;
    contacts.second_body[c] = row.second_body;
    contacts.collider[c] = row.collider;
    contacts.impulse[c] = Vec3::Zero();
    contacts.region[c] = no_index;
    contacts.slip[c] = Vec3::Zero();
    contacts.state[c] = ContactState::open;
}

/// Appends `row`. `impulse`: impulse with which the solver starts [N s].
inline void append_row(const ContactRow& row, const Vec3& impulse, ContactTable& contacts) {
    const std::size_t c = contacts.size();
    contacts.resize(c + 1);
    write_contact(row, c, contacts);
    contacts.impulse[c] = impulse;
}

}  // namespace skerry
