// Finds the contacts of this step among the candidates (docs/methods/contact.md 1.1, 3.1, docs/methods/collision.md 1,
// 4).
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Fills the contact table in key order. Returns false if no candidate has to be tested. Runs in parallel over blocks
/// of candidates.
///
/// A candidate becomes a contact if its gap could close within the step of length h; a margin accounts for the velocity
/// that forces can add. A candidate that cannot touch until the travel of the pair reaches asleep_until is skipped
/// after one comparison. Crossings from an earlier attempt at this step are added unchanged. In all new rows impulses
/// and slips are zero, regions are no_index and states are open.
bool find_contacts(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                   PairTable& pairs, CrossingTable& crossings, ContactTable& contacts);

}  // namespace skerry
