// Check of the motion of a step before it is taken: do surfaces pass through each other (docs/methods/collision.md 7)?
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Finds features of pairs whose surfaces are apart that would meet while every node moves by h (velocity_next +
/// push_out). Only pairs that could move by more than half of their least distance are tested, and of these only the
/// features that do: a slow scene takes one comparison per pair. Each hit is added to crossings.row as a contact with
/// the weights and the normal at the time of the hit; find_contacts adds it when the step is tried again. Pairs without
/// a contact distance are left out: they touch without having crossed. BodyTable::frame_speed must be that of this
/// motion. Returns the number of crossings that forbid the step: if it is not zero, the step must not be taken. If a
/// pair moves further than its candidate list is valid for, nothing is tested: beyond_lists is set, and the same try
/// must be repeated with the lists that find_candidates then makes. On the last try the pairs are marked as overlapping
/// instead, and zero is returned. Parallel over the blocks of find_contacts.
Index find_crossings(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<const Vec3> velocity_next, std::span<const Vec3> push_out, PairTable& pairs,
                     CrossingTable& crossings);

}  // namespace skerry
