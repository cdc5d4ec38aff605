// Contacts of this step from the candidates (docs/methods/contact.md 1.1, 3.1, docs/methods/collision.md 1, 4).
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Fills the contact table, in key order, with every candidate whose gap could close within the step of length h (with
/// a margin for the velocity that forces can add), and with those that crossed in an earlier try of this step, as they
/// met then. Candidates proven to stay apart for some travel are skipped by one comparison. Fills all columns but
/// impulse (zero), region (no_index), slip and state. Returns false when there are no candidates (skipped). Parallel
/// over pairs.
bool find_contacts(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                   PairTable& pairs, CrossingTable& crossings, ContactTable& contacts);

}  // namespace skerry
