// Stores the contacts between bodies that have fallen asleep, for as long as the bodies sleep (docs/methods/skipping.md
// 3.2).
#pragma once

#include <cstdint>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/pair_table.h"
#include "components/resting_contact_table.h"
#include "jobs/access.h"

namespace skerry {

struct RestingInputs {
    // Columns of PairTable. `pair`: ascending keys. `idle`: 1 for each pair for which this step did not search for
    // contacts, because neither partner moves.
    std::span<const std::uint64_t> pair;
    std::span<const std::uint8_t> idle;
    std::span<const std::uint8_t> asleep;  // by body: 1 if it is asleep after the step
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

/// Working memory of keep_resting_contacts, reused in later steps. `next` becomes the new table of stored contacts.
struct RestingMemory {
    // Source of each row of `next`: r for row r of the stored contacts, or ~r for row r of this step's contacts.
    Column<Index> source;
    RestingContactTable next;
};

/// Updates the stored contacts between sleeping bodies after a step, and returns false if nothing changes. This check
/// takes one pass over the contacts and one over the pairs. `kick`: time for which forces acted in this step [s].
/// - Contacts of this step are stored if both partners are asleep or do not move.
/// - Contacts that are already stored remain if their pair is idle (RestingInputs::idle).
bool keep_resting_contacts(const ContactTable& contacts, const RestingInputs& inputs, Real kick, RestingMemory& memory,
                           RestingContactTable& kept);

/// Lists the contacts to display, in key order. An entry is r for row r of `contacts`, or ~r for row r of `kept`. If a
/// contact is in both tables, because its bodies have just fallen asleep, the row of `contacts` is listed.
void merge_contacts(const ContactTable& contacts, const RestingContactTable& kept, Column<Index>& rows);

}  // namespace skerry
