// Warm start: the impulses of the last step are the initial guess for this step (docs/methods/region_solver.md 7).
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

/// Sets each impulse to the last impulse of the contact with the same key: the impulse of the last step, or of the step
/// in which the bodies fell asleep. New contacts get zero. Returns false if there is nothing to do (skipped). Parallel
/// over blocks of contacts.
///
/// The impulse is rotated with the contact normal. It is multiplied by `kick`, the time for which forces act in this
/// step [s], and divided by the corresponding time of the step in which it was stored. All tables are in key order, so
/// they are read side by side.
bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal,
                      const WarmStartTable& last, const RestingContactTable& resting, Real kick,
                      std::span<Vec3> impulse);

/// The contacts of this step, and data of their bodies.
struct ContactsNow {
    std::span<const ContactKey> key;
    std::span<const Vec3> normal, point;  // unit normals; contact points [m]
    std::span<const Index> first_body, second_body;
    std::span<const Range> body_rigid;  // rows of RigidBodyTable; empty for a body that is neither rigid nor implicit
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

/// Adds the impulse of each vanished contact (one of the last step that no longer exists) to a contact of the same
/// pair: the nearest one within twice the contact distance whose normal is similar. Otherwise the load that the
/// vanished contact carried would be lost. Two flat faces have more contacts than degrees of freedom, and rounding
/// makes contacts come and go.
///
/// Pairs without a rigid or implicit body are left out. Call it after match_warm_start. Returns false if there is
/// nothing to do (skipped). Parallel over blocks of pairs.
bool hand_on_impulses(Executor& executor, const ContactsNow& now, const WarmStartTable& last, Real kick,
                      std::span<Vec3> impulse);

/// Data of this step's contacts that the next warm start needs.
struct ContactsDone {
    std::span<const ContactKey> key;
    std::span<const Vec3> normal;
    std::span<const Vec3> impulse;     // [N s]
    std::span<const Vec3> point = {};  // contact points; empty if no body is rigid or implicit [m]

    /// `frames_on_ranks`: true if any rank (process of a parallel run) has a body with a frame, that is, a rigid or
    /// implicit body. All ranks then store the points, because their contacts may move to other ranks.
    static ContactsDone bind(const Binder& binder, const ContactTable& contact, const RigidBodyTable& rigid,
                             const bool& frames_on_ranks) {
        return {
            .key = binder.read(contact.key),
            .normal = binder.read(contact.normal),
            .impulse = binder.read(contact.impulse),
            .point = binder.read_if(!binder.value(rigid.mass).empty() || binder.value(frames_on_ranks), contact.point)};
    }
};

/// Stores the impulses of this step for the next step. Parallel over contacts.
void store_warm_start(Executor& executor, const ContactsDone& done, Real kick, WarmStartTable& last);

}  // namespace skerry
