// Sums of the contact impulses of this step, pair by pair.
#pragma once

#include <cstdint>
#include <span>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/column.h"
#include "components/contact_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// Partners of a contact: a body and a collider, two bodies, or a body and itself. Of two bodies, the one with the
/// lower number BodyTable::slot comes first. `collider` is a row of ColliderTable, also for a mesh collider.
struct ContactPartners {
    Index first = no_index;     // row of BodyTable; a deformable body
    Index second = no_index;    // row of BodyTable; a deformable body, or no_index
    Index collider = no_index;  // row of ColliderTable, or no_index

    bool operator==(const ContactPartners&) const = default;
};

/// Sums of impulses and moments over contacts. The impulses act at the nodes of a body, and at the contact point of a
/// collider. Each moment is the change of angular momentum of one partner. The two do not add up to zero, because
/// friction acts at two points a small distance apart.
struct ContactSums {
    Vec3 impulse = Vec3::Zero();        // impulse on the first partner [N s]
    Vec3 first_moment = Vec3::Zero();   // moment on the first partner [N m s]
    Vec3 second_moment = Vec3::Zero();  // moment on the second partner [N m s]
    Vec3 friction = Vec3::Zero();       // sum of the tangential parts of the impulses on the first partner [N s]
    Real pressing = 0;                  // sum of the magnitudes of the normal parts of the impulses [N s]

    ContactSums& operator+=(const ContactSums& more) {
        impulse += more.impulse;
        first_moment += more.first_moment;
        second_moment += more.second_moment;
        friction += more.friction;
        pressing += more.pressing;
        return *this;
    }
    friend ContactSums operator*(Real factor, const ContactSums& sums) {
        return {factor * sums.impulse, factor * sums.first_moment, factor * sums.second_moment, factor * sums.friction,
                factor * sums.pressing};
    }
};

struct PairSums {
    ContactPartners partners;
    ContactSums sums{};
    Index contacts = 0;  // number of contacts of the pair with a nonzero impulse
};

struct ContactSumInputs {
    std::span<const Stencil> stencil;
    std::span<const Vec3> point, normal, impulse;
    std::span<const Index> first_body, second_body, collider;
    std::span<const BodyKind> body_kind;
    std::span<const std::uint32_t> body_slot;
    std::span<const Real> round_radius;
    std::span<const Vec3> position;      // by node: position at which impulses act [m]
    std::span<const Real> inverse_mass;  // by node [1/kg]
    std::span<const Index> held;         // rows of nodes that attachments hold
    std::span<const Index> core_nodes;   // BodyTable
    TouchPoints touch;

    static ContactSumInputs bind(const Binder& binder, const ContactTable& contact, const BodyTable& body,
                                 const NodeTable& node, const AttachmentTable& attachment) {
        return {.stencil = binder.read(contact.stencil),
                .point = binder.read(contact.point),
                .normal = binder.read(contact.normal),
                .impulse = binder.read(contact.impulse),
                .first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .collider = binder.read(contact.collider),
                .body_kind = binder.read(body.kind),
                .body_slot = binder.read(body.slot),
                .round_radius = binder.read(body.round_radius),
                .position = binder.read(node.position),
                .inverse_mass = binder.read(node.inverse_mass),
                .held = binder.read(attachment.node),
                .core_nodes = binder.read(body.core_nodes),
                .touch = TouchPoints::bind(binder, contact)};
    }
};

/// Sums the contacts with a nonzero impulse: one row per pair, in contact order. Moments are about `moment_point`.
/// `held_impulse`: by node, sum of the contact impulses on a node that no impulse can move [N s]; valid only for nodes
/// that attachments hold. Runs sequentially.
void sum_contact_impulses(const ContactSumInputs& contacts, const Vec3& moment_point, Column<PairSums>& pairs,
                          Column<Vec3>& held_impulse);

}  // namespace skerry
