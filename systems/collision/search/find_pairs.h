// Broad search for pairs of two bodies, or of a body and a collider, that are near each other.
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Lists all pairs whose partners could come near each other before the next broad search. This search is due when a
/// travel bound reaches body_valid_until or collider_valid_until, which are set here. The boxes of all partners are
/// grown accordingly, and pairs of overlapping boxes are listed in key order. A pair that existed before keeps its
/// candidates, unless one of the partners is forgotten. Bodies without a surface and pairs without a deformable body
/// are left out. Overlapping boxes are found in a grid (BoxGrid); planes are compared with every body. Requires
/// memory.body_travel_bound, body_forgotten and collider_forgotten of this step. Runs in parallel over blocks of
/// bodies, then of pairs.
void find_pairs(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                SearchState& search, PairTable& pairs);

/// Fits the box and the bounding sphere of a body to its present positions.
void fit_bounds(const CollisionInputs& inputs, Index body, Aabb& box, BoundingSphere& sphere);

}  // namespace skerry
