// What contacts gave in this step, pair by pair.
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

/// Who touches: a body and a collider (`collider` is a row, mesh colliders included), two bodies, the one of the lower
/// slot first, or a body and itself.
struct ContactPartners {
    Index first = no_index;     // row of BodyTable, of a deformable body
    Index second = no_index;    // row of BodyTable, of a deformable body, or no_index
    Index collider = no_index;  // row of ColliderTable, or no_index

    bool operator==(const ContactPartners&) const = default;
};

/// Sums over contacts. The moments of the partners differ by what the distance of their surfaces makes of friction:
/// each is that of the nodes, or of the point of the collider, which the impulses act on, so that it is what changes
/// the angular momentum of the partner.
struct ContactSums {
    Vec3 impulse = Vec3::Zero();        // N s, on the first
    Vec3 first_moment = Vec3::Zero();   // N m s, on the first
    Vec3 second_moment = Vec3::Zero();  // N m s, on the second
    Vec3 friction = Vec3::Zero();       // N s, the tangential parts of `impulse`
    Real pressing = 0;                  // N s, sum of the sizes of the normal parts

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
    Index contacts = 0;  // with an impulse
};

struct ContactSumInputs {
    std::span<const Stencil> stencil;
    std::span<const Vec3> point, normal, impulse;
    std::span<const Index> first_body, second_body, collider;
    std::span<const BodyKind> body_kind;
    std::span<const std::uint32_t> body_slot;
    std::span<const Real> round_radius;
    std::span<const Vec3> position;      // m, by node: where the impulses act
    std::span<const Real> inverse_mass;  // 1/kg, by node
    std::span<const Index> held;         // nodes
    std::span<const Index> core_nodes;   // BodyTable
    TouchPlaces touch;

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
                .touch = TouchPlaces::bind(binder, contact)};
    }
};

/// Sums of the contacts with an impulse, one row a pair, in the order of the contacts; moments about `moment_point`.
/// `held_impulse`: N s, by node, what contacts gave to nodes that no impulse moves; elsewhere it means nothing.
/// Sequential.
void sum_contact_impulses(const ContactSumInputs& contacts, const Vec3& moment_point, Column<PairSums>& pairs,
                          Column<Vec3>& held_impulse);

}  // namespace skerry
