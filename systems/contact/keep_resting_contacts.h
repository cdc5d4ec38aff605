// What is known of the contacts between what comes to rest is kept while it rests (docs/methods/skipping.md 3.2).
#pragma once

#include <cstdint>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/pair_table.h"
#include "components/resting_contact_table.h"
#include "jobs/access.h"

namespace skerry {

struct RestingInputs {
    // PairTable: its key, ascending, and which pairs were not looked at in this step, since neither partner moves
    std::span<const std::uint64_t> pair;
    std::span<const std::uint8_t> idle;
    std::span<const std::uint8_t> asleep;  // by body, after the step
    std::span<const BodyKind> kind;
    std::span<const Index> collider_of_body;
    std::span<const RigidMotion> motion;  // by collider

    static RestingInputs bind(const Binder& binder, const PairTable& pair, const BodyTable& body,
                              const ColliderTable& collider) {
        return {.pair = binder.read(pair.key),
                .idle = binder.read(pair.idle),
                .asleep = binder.read(body.asleep),
                .kind = binder.read(body.kind),
                .collider_of_body = binder.read(body.collider),
                .motion = binder.read(collider.motion)};
    }
};

/// Room to work in.
struct RestingMemory {
    Column<Index> source;  // by row of `next`: row of what was kept, or the complement of a row of this step's contacts
    RestingContactTable next;
};

/// After a step in which forces acted for `kick` (s): keeps the contacts of this step all of whose sides rest or stand
/// still, and of those kept before the ones of pairs that this step did not look at. Returns false, and costs a look at
/// the contacts and one at the pairs, where nothing changes.
bool keep_resting_contacts(const ContactTable& contacts, const RestingInputs& inputs, Real kick, RestingMemory& memory,
                           RestingContactTable& kept);

/// The rows to show of both, in key order: a row of the step's contacts, or the complement of a row of those that rest.
/// Of those that are in both, since their bodies have just come to rest, the step's.
void merge_contacts(const ContactTable& contacts, const RestingContactTable& kept, Column<Index>& rows);

}  // namespace skerry
