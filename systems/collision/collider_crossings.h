// Features of a body that would go through an analytic collider in the motion of the step.
#pragma once

#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// The motion that is about to be taken.
struct StepMotion {
    std::span<const Vec3> velocity_next, push_out;  // m/s, by node
    Real h;                                         // s

    Vec3 of(Index node) const { return h * (velocity_next[node] + push_out[node]); }
};

/// Features that approach each other by less than this fraction of their distance in the step cannot meet, by far.
inline constexpr Real slow_fraction = 0.5;

/// Looks at the candidates of pair p in a range that can have come near by `travel_bound` (m); what would cross is
/// appended as a contact. Returns how many were tested.
std::uint64_t find_collider_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, Column<ContactRow>& found);

}  // namespace skerry
