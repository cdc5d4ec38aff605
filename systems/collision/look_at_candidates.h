// Which candidates of a pair are contacts of this step.
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Looks at those candidates of pair p (row of `pairs`) in a range of its list that are awake, appends what may close
/// within the step of length h to `found`, in their order, and notes until when the others may sleep. Returns the least
/// distance of the features that were looked at, m. Eight are looked at together; without use_budgets each by itself,
/// asleep or not (the simple twin). Of those that were looked at appends to `near` what is no further apart than twice
/// what the pair may close: others cannot meet while it closes no more (slow_fraction).
Real look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                        PairTable& pairs, Column<ContactRow>& found, Column<NearCandidate>& near);

}  // namespace skerry
