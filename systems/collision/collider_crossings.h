// Features of a body that would go through an analytic collider in the motion of the step.
#pragma once

#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/step_motion.h"

namespace skerry {

/// Looks at the candidates of pair p in a range that can have come near by `travel_bound` (m); what would cross is
/// appended as a contact. Returns how many were tested.
std::uint64_t find_collider_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, Column<ContactRow>& found);

}  // namespace skerry
