// Search for pairs of bodies that could touch soon, and for pairs of their features that could touch soon
// (docs/methods/collision.md 1 to 3).
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Updates the list of pairs, and the candidate list (features near each other) of each pair. A list expires when the
/// bodies may have moved so far that it could lack something. If no list has expired, the call takes only one
/// comparison per body, collider and pair, and returns false.
///
/// - The list of pairs expires when a body or collider has travelled up to its limit (SearchState). A broad search then
///   lists all pairs again.
/// - For each pair with an expired candidate list, the trees of its bodies are refitted to the present node positions
///   and traversed, in parallel over the pairs. `box`: boxes of BvhTable, which this function refits.
///
/// BodyTable::travel must bound the motion of every node since the body was added. max_speed and frame_speed must be
/// the greatest node speeds of the last step.
///
/// A new body, or one that the user has moved, has no such bounds. It is marked as forgotten (SearchState): every
/// attempt at the next step searches all of its pairs again, and bounds its motion by its present velocities.
///
/// Pairs are in key order, candidates in feature order.
bool find_candidates(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<Aabb> box, SearchState& search, PairTable& pairs);

}  // namespace skerry
