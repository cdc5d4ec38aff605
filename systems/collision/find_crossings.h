// Looks at the motion of the step before it is taken: do surfaces go through each other (docs/methods/collision.md 7)?
#pragma once

#include "components/pair_table.h"
#include "jobs/executor.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Features of pairs whose surfaces are apart that would come together while every node moves by h (velocity_next +
/// push_out). Only pairs that could move by more than half of their least distance are looked at, and of these only
/// features that do: a slow scene pays one comparison a pair. Each hit is added to crossings.row as a contact with the
/// weights and the normal at the time of the hit, which find_contacts takes over when the step is tried again. Pairs
/// without a contact distance are left out: they touch without having crossed. BodyTable::frame_speed must be that of
/// this motion. Returns how many crossings stand against the step: not zero means that it must not be taken. Where a
/// pair moves further than its list of candidates is good for nothing is looked at: beyond_lists is set, and the same
/// try has to be made again with the lists that find_candidates then makes. On the last try the pairs are marked as
/// overlapping instead, and zero is returned. Parallel over the blocks of find_contacts.
Index find_crossings(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<const Vec3> velocity_next, std::span<const Vec3> push_out, PairTable& pairs,
                     CrossingTable& crossings);

}  // namespace skerry
