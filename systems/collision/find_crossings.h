// Checks before a step is committed whether surfaces pass through each other during the step (docs/methods/collision.md
// 7).
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Finds features that would pass through each other while every node moves by h (velocity_next + push_out). Returns
/// zero if the step may be committed, otherwise the number of crossings plus the number of pairs that move further than
/// their candidate lists are valid for. Runs in parallel over the blocks of find_contacts.
///
/// - Only pairs with a positive contact distance are tested, and pairs of surfaces only if these are known to be apart.
///   Without a contact distance, a touch cannot be distinguished from a crossing.
/// - Slow candidates are skipped: all candidates of a pair in one block if the relative motion of the pair is at most
///   half of their least distance, else each candidate for which it is at most half of its own distance.
///   BodyTable::frame_speed must have been measured for the motion h (velocity_next + push_out).
/// - Each crossing is stored in crossings.found as a contact, with the weights and the normal at the time when the
///   features meet.
/// - If a pair moves further than its candidate list is valid for, and extends_lists is set, no features are tested.
///   Instead beyond_lists is set; the attempt must be repeated with new lists from find_candidates.
/// - In the last attempt (last_attempt) crossings are permitted, and the function returns zero.
Index find_crossings(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<const Vec3> velocity_next, std::span<const Vec3> push_out, PairTable& pairs,
                     CrossingTable& crossings);

/// Must be called after an attempt in which find_crossings has found crossings. Adds them to crossings.row, so that
/// find_contacts adds these contacts in the next attempt at the step. After the last attempt (last_attempt), marks the
/// pairs of the crossings as overlapping instead.
void use_crossings(PairTable& pairs, CrossingTable& crossings);

}  // namespace skerry
