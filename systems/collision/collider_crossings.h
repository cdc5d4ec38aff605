// Features of a body that would pass through an analytic collider in the motion of the step.
#pragma once

#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/step_motion.h"

namespace skerry {

/// Tests the candidates of pair p in a range that can have come near by `travel_bound` [m]. Features that would cross
/// are appended as contacts. Returns the number of candidates tested.
std::uint64_t find_collider_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, Column<ContactRow>& found);

}  // namespace skerry
