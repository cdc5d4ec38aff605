// Checks before a step is committed whether surfaces pass through each other during the step (docs/methods/collision.md
// 7).
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Finds features that would pass through each other while every node moves by h (velocity_next + push_out). Returns
/// the number of crossings; if it is not zero, the step must not be committed. Runs in parallel over the blocks of
/// find_contacts.
///
/// Only pairs with a contact distance whose surfaces are apart are tested; without a contact distance, surfaces may
/// touch without having crossed. A pair is tested only if it could move by more than half of its least distance, a
/// candidate only if it could move by more than half of its distance. A slow scene therefore takes one comparison per
/// pair. BodyTable::frame_speed must be the speed of this motion.
///
/// Each crossing is added to crossings.row as a contact, with the weights and the normal at the time when the features
/// meet. find_contacts adds these contacts in the next attempt at the step. If a pair moves further than its candidate
/// list is valid for, no features are tested. Instead beyond_lists is set, and the attempt must be repeated with new
/// lists from find_candidates. In the last attempt pairs with crossings are marked as overlapping, and zero is
/// returned.
Index find_crossings(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<const Vec3> velocity_next, std::span<const Vec3> push_out, PairTable& pairs,
                     CrossingTable& crossings);

}  // namespace skerry
