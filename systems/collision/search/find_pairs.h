// The broad search for pairs of bodies, or of a body and a collider, that are near each other.
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Lists every pair whose boxes are nearer than both may travel until their travel_bound reaches body_valid_until or
/// collider_valid_until, which are set here. Pairs are in key order. A pair that stays keeps its candidates, unless one
/// of its two is forgotten. Bodies without a surface and pairs without a deformable body are left out. Boxes that meet
/// are found in a grid (BoxGrid); planes are compared with every body. Requires memory.body_travel_bound,
/// body_forgotten and collider_forgotten of this step. Runs in blocks of bodies, then of pairs.
void find_pairs(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                SearchState& search, PairTable& pairs);

/// Fits box and sphere to the present shape of a body.
void fit_bounds(const CollisionInputs& inputs, Index body, Aabb& box, BoundingSphere& sphere);

}  // namespace skerry
