// Which candidates of a pair are contacts of this step.
#pragma once

#include <span>

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Looks at those candidates of pair p (row of `pairs`) in a range of its list that are awake, without use_budgets at
/// all of them, one by one: appends what may close within the step of length h to `found`, in their order, and notes
/// until when the others may sleep. Returns the least distance of the features that were looked at, m. Of two bodies
/// this is the simple twin of look_at_awake.h.
Real look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                        PairTable& pairs, Column<ContactRow>& found);

/// The same of some candidates of two bodies, none of them a cylinder; `rows` of their list.
void look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p,
                        std::span<const Index> rows, PairTable& pairs, Column<ContactRow>& found);

}  // namespace skerry
