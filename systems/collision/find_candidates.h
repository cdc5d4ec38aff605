// Which bodies, and which of their features, could touch soon (docs/methods/collision.md 1 to 3).
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Brings the pair list and the candidate lists up to date. Nothing close: one comparison per body and per pair, then
/// returns false (skipped). Otherwise first the broad search (sweep over body boxes; only when some body used up its
/// budget of travel), then, for each pair whose own budget is used up, a refit of its trees and a traversal, in
/// parallel over those pairs. `box` is that of BvhTable, refit here. The budgets are
/// explained in contact_reach.h; they rest on BodyTable::travel, which must bound the motion of every node since the
/// body was added, and on BodyTable::max_speed and frame_speed, of the motion that led to the present positions. Where
/// that is not so (a new body, one moved by hand) it is forgotten (SearchState): its pairs are then found and searched
/// afresh with the present velocities, and no others; these count in all tries of the step (SearchState::end_step).
/// Deterministic: pairs in key order, candidates in feature order.
bool find_candidates(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<Aabb> box, SearchState& search, PairTable& pairs);

}  // namespace skerry
