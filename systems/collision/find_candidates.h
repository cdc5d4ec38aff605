// Search for bodies, and for their features, that could touch soon (docs/methods/collision.md 1 to 3).
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Updates the pair list and the candidate lists. If nothing is close, it takes one comparison per body and per pair
/// and returns false (skipped). Otherwise the broad search runs first, if a body or collider has used up its budget of
/// travel. Then the trees of each pair whose own budget is used up are refit and traversed, in parallel over those
/// pairs. `box` is that of BvhTable, refit here. The budgets are explained in contact_reach.h. They rest on
/// BodyTable::travel, which must bound the motion of every node since the body was added, and on BodyTable::max_speed
/// and frame_speed of the motion that led to the present positions. A body for which this does not hold (new, or moved
/// by hand) is forgotten (SearchState): only its pairs are found and searched afresh, with the present velocities,
/// which count in all tries of the step (SearchState::end_step). The result is deterministic: pairs are in key order,
/// candidates in feature order.
bool find_candidates(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<Aabb> box, SearchState& search, PairTable& pairs);

}  // namespace skerry
