// Contacts of this step from the candidates (docs/methods/contact.md 1.1, 3.1, docs/methods/collision.md 1, 4).
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Fills the contact table, in key order, with every candidate whose gap could close within the step of length h (with
/// a margin for the velocity that forces can add). Crossings from an earlier try of this step are added as they were
/// found. Candidates proven to stay apart for some travel are skipped by one comparison. Impulse and slip are set to
/// zero, region to no_index and state to open. Returns false if there are no candidates (skipped). Parallel over blocks
/// of candidates.
bool find_contacts(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                   PairTable& pairs, CrossingTable& crossings, ContactTable& contacts);

}  // namespace skerry
