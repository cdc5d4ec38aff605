// Search for pairs of bodies that could touch soon, and for pairs of their features that could touch soon
// (docs/methods/collision.md 1 to 3).
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Updates the list of pairs and the candidate list of each pair. If no list has expired, the call takes only one
/// comparison per body, collider and pair, and returns false.
///
/// If a body or collider has travelled up to its limit (SearchState), a broad search lists all pairs again. For each
/// pair with an expired candidate list, the trees of its bodies are refitted to the present node positions and
/// traversed, in parallel over the pairs. `box`: boxes of BvhTable, which this function refits.
///
/// The limits of travel (contact_reach.h) require that BodyTable::travel bounds the motion of every node since the body
/// was added, and that BodyTable::max_speed and frame_speed are the greatest node speeds of the last step. A body
/// without such bounds (new, or moved by the user) is marked as forgotten (SearchState). In every attempt at the next
/// step, its pairs are then found and searched again, with bounds from its present velocities.
///
/// The result is deterministic: pairs are in key order, candidates in feature order.
bool find_candidates(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<Aabb> box, SearchState& search, PairTable& pairs);

}  // namespace skerry
