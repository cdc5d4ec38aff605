// Selection of the candidates of a pair that are contacts of this step.
#pragma once

#include <span>

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Tests the awake candidates of pair p (row of `pairs`) in a range of its list one by one; without use_budgets it
/// tests all. Candidates whose gap may close within the step of length h are appended to `found`, in order. It stores
/// until when the tested candidates may sleep. Returns the least distance of the tested features [m]. For two bodies
/// this is the simple twin of look_at_awake.h.
Real look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                        PairTable& pairs, Column<ContactRow>& found);

/// Tests some candidates of two bodies, neither of them a cylinder, and appends contacts to `found`. `rows`: places in
/// the list of the pair.
void look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p,
                        std::span<const Index> rows, PairTable& pairs, Column<ContactRow>& found);

}  // namespace skerry
