// Carries impulses from the last step to this one (docs/methods/region_solver.md 7).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/contact_table.h"
#include "components/range.h"
#include "components/resting_contact_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

/// impulse = last step's impulse of the same key, or that with which it came to rest, turned so that the old normal
/// becomes the new one, times kick, for which forces act in this step, over that of the step that it belongs to; zero
/// for a new contact. All tables are in key order: a merge. Parallel over blocks of contacts. Returns false when there
/// is nothing to do (skipped).
bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal,
                      const WarmStartTable& last, const RestingContactTable& resting, Real kick,
                      std::span<Vec3> impulse);

/// The contacts of this step, and how their bodies move.
struct ContactsNow {
    std::span<const ContactKey> key;
    std::span<const Vec3> normal, point;  // unit; m
    std::span<const Index> first_body, second_body;
    std::span<const Range> body_rigid;            // of RigidBodyTable: empty where a body moves node by node
    std::span<const Real> body_contact_distance;  // [m]

    static ContactsNow bind(const Binder& binder, const ContactTable& contact, const BodyTable& body) {
        return {.key = binder.read(contact.key),
                .normal = binder.read(contact.normal),
                .point = binder.read(contact.point),
                .first_body = binder.read(contact.first_body),
                .second_body = binder.read(contact.second_body),
                .body_rigid = binder.read(body.rigid),
                .body_contact_distance = binder.read(body.contact_distance)};
    }
};

/// What contacts that are gone carried goes to the nearest contact of their pair within twice the contact distance, if
/// its normal is about the same. For pairs of which a body is rigid or implicit: faces that lie on each other have more
/// contacts than freedoms, which come and go by the last bits of places, and each takes a part of the weight along.
/// After match_warm_start. Parallel over blocks of pairs. Returns false when there is nothing to do (skipped).
bool hand_on_impulses(Executor& executor, const ContactsNow& now, const WarmStartTable& last, Real kick,
                      std::span<Vec3> impulse);

/// What is kept of a step's contacts.
struct ContactsDone {
    std::span<const ContactKey> key;
    std::span<const Vec3> normal;
    std::span<const Vec3> impulse;     // [N s]
    std::span<const Vec3> point = {};  // m; empty where nothing is rigid or implicit

    static ContactsDone bind(const Binder& binder, const ContactTable& contact, const RigidBodyTable& rigid) {
        return {.key = binder.read(contact.key),
                .normal = binder.read(contact.normal),
                .impulse = binder.read(contact.impulse),
                .point = binder.read_if(!binder.value(rigid.mass).empty(), contact.point)};
    }
};

/// Keeps this step's impulses for the next. Parallel over contacts.
void store_warm_start(Executor& executor, const ContactsDone& done, Real kick, WarmStartTable& last);

}  // namespace skerry
