// Search for pairs of bodies, and for pairs of their features, that could touch soon (docs/methods/collision.md 1 to
// 3).
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Updates the list of pairs and the candidate list of each pair. Returns false (skipped) if no list has expired, which
/// costs one comparison per body and per pair. Otherwise, if a body or collider has travelled up to its limit, the
/// broad search lists the pairs again. Then the trees of each pair with an expired candidate list are refit and
/// traversed, in parallel over these pairs. `box`: boxes of BvhTable, refit here. The limits of travel are explained in
/// contact_reach.h. They require that BodyTable::travel bounds the motion of every node since the body was added.
/// BodyTable::max_speed and frame_speed must be speeds of the motion to the present positions. A body without these
/// bounds (new, or moved by hand) is marked as forgotten (SearchState). Then only the pairs of this body are found and
/// searched again, with its present velocities, in all attempts at the step (SearchState::end_step). The result is
/// deterministic: pairs are in key order, candidates in feature order.
bool find_candidates(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<Aabb> box, SearchState& search, PairTable& pairs);

}  // namespace skerry
