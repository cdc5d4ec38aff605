// Broad search for pairs of two bodies, or of a body and a collider, that are close to each other.
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Lists all pairs of objects that could come close to each other before the next broad search, in key order. This
/// search is due when a travel bound (contact_reach.h) reaches body_valid_until or collider_valid_until, which this
/// function sets. Requires memory.body_travel_bound, body_reach, body_forgotten and collider_forgotten of this step.
/// Runs in parallel over blocks of bodies, then over blocks of pairs.
///
/// - The boxes of all objects are enlarged accordingly. Overlapping boxes are found in a grid (BoxGrid); planes are
///   compared with every body.
/// - A pair that existed before keeps its candidates, unless one of its partners is forgotten (added or moved by the
///   user).
/// - Bodies without a surface and pairs without a deformable body are not listed.
void find_pairs(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                SearchState& search, PairTable& pairs);

/// Computes the box and the bounding sphere of a body from its present node positions.
void fit_bounds(const CollisionInputs& inputs, Index body, Aabb& box, BoundingSphere& sphere);

}  // namespace skerry
