// The broad search: which pairs of bodies, or of a body and a collider, are near enough to be looked into.
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Lists every pair whose boxes are nearer than what both may travel until their travel_bound reaches body_valid_until
/// or collider_valid_until, which are set here. Pairs in key order. A pair that stays keeps its candidates, unless one
/// of its two is forgotten. Left out: bodies without a surface, pairs without a deformable body. Boxes
/// that meet are looked up in a grid (BoxGrid); planes are compared with every body. Wants memory.body_travel_bound,
/// body_forgotten and collider_forgotten of this step. In blocks of bodies, then of pairs.
void find_pairs(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                SearchState& search, PairTable& pairs);

}  // namespace skerry
