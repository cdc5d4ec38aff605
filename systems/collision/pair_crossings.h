// Tests whether features of one pair would pass through each other, or enter a shape, during the step.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/range.h"
#include "systems/collision/colliders/time_of_touch.h"
#include "systems/collision/contact_rows.h"
#include "systems/collision/inputs/step_motion.h"

namespace skerry {

/// Tests the candidates in `range` of pair p, a body and an analytic collider, and appends features that would cross in
/// this step to `found` as contacts. Returns the number of tested candidates. Candidates whose asleep_until is above
/// `travel_bound` are skipped, because they cannot meet. `travel_bound`: upper bound of the travel of the pair
/// (contact_reach.h) at the end of this step [m].
std::uint64_t find_collider_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, Column<ContactRow>& found);

/// Variant of find_collider_crossings for a rigid cylinder and another body or an analytic collider. `known`: crossings
/// that earlier attempts at the step have found, in key order.
std::uint64_t find_cylinder_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, std::span<const ContactRow> known,
                                      Column<ContactRow>& found);

/// Calls test(c) for each candidate c in a range whose features may meet in this step, and returns the number of calls
/// that returned true. test(c) returns false if a bound on the motion already excludes a crossing. `travel_bound`:
/// upper bound of the travel of the pair (contact_reach.h) at the end of this step [m].
std::uint64_t count_tested(std::span<const Real> asleep_until, Range range, Real travel_bound, auto&& test) {
    std::uint64_t tested = 0;
    for (Index c = range.begin; c < range.end; ++c)
        // Candidates with a larger asleep_until cannot meet.
        if (!(travel_bound < asleep_until[static_cast<std::size_t>(c)])) tested += test(c);
    return tested;
}

/// Base class of the crossing tests of one pair.
struct PairCrossings : PairData {
    const StepMotion& motion;
    Column<ContactRow>& found;

    PairCrossings(const CollisionInputs& all_inputs, const StepMotion& step_motion, const PairTable& pairs, Index p,
                  Column<ContactRow>& rows)
        : PairData(all_inputs, pairs, p), motion(step_motion), found(rows) {}

    TouchingFeature feature_of(TouchingFeature::Kind feature_kind, const std::array<Index, 3>& node,
                               Index part_or_point, const ContactThreshold& threshold) const {
        TouchingFeature feature{
            .kind = feature_kind, .part_or_point = part_or_point, .position = {}, .threshold = threshold};
        for (std::size_t i = 0; i < feature.nodes(); ++i) {
            feature.position[i] = inputs.position[node[i]];
            feature.displacement[i] = motion.displacement(node[i]);
        }
        return feature;
    }
};

}  // namespace skerry
