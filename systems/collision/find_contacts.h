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
/// A candidate becomes a contact if its gap could close within the step of length h (docs/methods/collision.md 1). It
/// is skipped after one comparison while the travel_bound of the pair is below its asleep_until. Crossings from earlier
/// attempts at this step (crossings.row) are added unchanged. In all new rows impulses and slips are zero, regions are
/// no_index and states are open.
bool find_contacts(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                   PairTable& pairs, CrossingTable& crossings, ContactTable& contacts);

}  // namespace skerry
