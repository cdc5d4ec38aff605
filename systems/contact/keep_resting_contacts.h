// Keeps the contacts between bodies that have come to rest for as long as they rest (docs/methods/skipping.md 3.2).
#pragma once

#include <cstdint>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/pair_table.h"
#include "components/resting_contact_table.h"
#include "jobs/access.h"

namespace skerry {

struct RestingInputs {
    // PairTable: the keys, ascending, and which pairs were left out of this step because neither partner moves
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

/// Working memory.
struct RestingMemory {
    Column<Index> source;  // by row of `next`: a kept row, or the complement of a row of this step's contacts
    RestingContactTable next;
};

/// Updates the resting contacts after a step in which forces acted for `kick` [s]. Keeps the contacts of this step
/// whose sides both rest or stand still, and the previously kept contacts of pairs that this step left out. Returns
/// false if nothing changes; this costs one pass over the contacts and one over the pairs.
bool keep_resting_contacts(const ContactTable& contacts, const RestingInputs& inputs, Real kick, RestingMemory& memory,
                           RestingContactTable& kept);

/// Lists the rows to display of both tables, in key order: a row of the step's contacts, or the complement of a row of
/// the resting ones. A contact in both, whose bodies have just come to rest, is listed as the step's.
void merge_contacts(const ContactTable& contacts, const RestingContactTable& kept, Column<Index>& rows);

}  // namespace skerry
