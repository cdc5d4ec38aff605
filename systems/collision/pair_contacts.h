// Contact tests of the candidates of one pair in one step. A candidate is two features near each other; it becomes a
// contact if its gap may close within the step of length h. The tests also write asleep_until: while the travel bound
// of the pair (contact_reach.h) is below this value, the candidate needs no test.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "components/range.h"
#include "systems/collision/contact_rows.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/geometry/lane_mask.h"

namespace skerry {

/// Tests the candidates in `range` of the list of pair p, a body and an analytic collider. If use_budgets is set,
/// candidates that cannot touch in this step are skipped.
///
/// Returns a lower bound of the distances of the tested features from the collider [m]. Exception: an edge or face in a
/// flat region of the collider (flat_region) can touch only at its nodes, which are candidates of their own. If the
/// distance that it can move within this region (flat_reach) is larger, this distance counts instead.
Real find_collider_contacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p,
                            Range range, PairTable& pairs, Column<ContactRow>& found);

/// Variant of find_collider_contacts for a pair of a rigid cylinder and another body or an analytic collider.
Real find_cylinder_contacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p,
                            Range range, PairTable& pairs, Column<ContactRow>& found);

// Number of candidates whose asleep_until is compared at once, without a branch for each candidate.
inline constexpr Index candidates_at_once = 16;

// A triangle at the distance d' from a point counts as nearer than a triangle at the distance d only if d - d' exceeds
// this fraction of the sum of d and the mean edge length. Smaller differences may be rounding errors.
inline constexpr Real nearer_fraction = 1e-9;

/// Bit mask for candidates_at_once candidates from index `begin` on: bit l is set if candidate begin + l may touch in
/// this step.
inline unsigned awake_lanes(std::span<const Real> asleep_until, Index begin, Real travel_bound) {
    typedef Real InMemory __attribute__((vector_size(sizeof(KernelReal)), aligned(alignof(Real)), may_alias));
    constexpr auto lanes = static_cast<Index>(lanes_of<KernelReal>);
    static_assert(candidates_at_once % lanes == 0);
    const Real* const until = asleep_until.data() + begin;
    unsigned awake = 0;
    for (Index l = 0; l < candidates_at_once; l += lanes)
        awake |= bits_of(~(travel_bound < *reinterpret_cast<const InMemory*>(until + l))) << l;
    return awake;
}

/// Calls test(c), in list order, for each candidate c whose features may touch in this step. `range`: range of the
/// candidate list of pair p. Without use_budgets, test(c) is called for all candidates in the range.
void for_each_awake(const CollisionSettings& settings, const PairTable& pairs, Index p, Range range, auto&& test) {
    const std::span<const Real> asleep_until = pairs.asleep_until[p].span();
    const Real travel_bound = settings.use_budgets ? pairs.travel_bound[p] : infinity;
    Index c = range.begin;
    for (; c + candidates_at_once <= range.end; c += candidates_at_once)
        for_each_lane(awake_lanes(asleep_until, c, travel_bound),
                      [&](std::size_t l) { test(c + static_cast<Index>(l)); });
    for (; c < range.end; ++c)
        if (!(travel_bound < asleep_until[static_cast<std::size_t>(c)])) test(c);
}

/// Upper limit of the distance at which a contact is computed [m]: features that are farther apart do not touch in this
/// step. `closing`: distance by which the partners may approach in this step [m].
inline Real near_distance(const PairScale& scale, Real closing) {
    return scale.contact_distance + (closing >= 0 ? closing : 0);
}

/// Base class of the contact tests of one pair.
struct PairContacts : PairData {
    const CollisionSettings& settings;
    const Real h;
    // T0 in contact_reach.h: features that are now at the distance d cannot meet while PairTable::travel_bound is below
    // T0 + d [m].
    const Real travel_base;
    const Real contact_limit;  // features farther apart than this get no contact (near_distance) [m]
    const bool held_apart;     // true: the surfaces cannot have passed through each other (is_held_apart)
    std::span<Real> asleep_until;
    Column<ContactRow>& found;

    PairContacts(const CollisionInputs& all_inputs, const CollisionSettings& all_settings, Real step, PairTable& pairs,
                 Index p, Column<ContactRow>& rows)
        : PairData(all_inputs, pairs, p),
          settings(all_settings),
          h(step),
          travel_base(pair_travel_base(inputs, pairs, p)),
          contact_limit(near_distance(scale, pairs.closing[p])),
          held_apart(is_held_apart(settings, state, scale)),
          asleep_until(pairs.asleep_until[p].span()),
          found(rows) {}

    bool within_reach(Real distance, Real relative_speed) const {
        const Real gap = distance - scale.contact_distance;
        return gap <= reach(h, relative_speed, settings.gravity, scale.shell);
    }

    /// Greatest speed of the given nodes relative to the velocity `velocity` [m/s].
    Real speed_against(const Vec3& velocity, std::span<const Index> nodes) const {
        Real squared = 0;
        for (const Index n : nodes) squared = std::max(squared, (inputs.velocity[n] - velocity).squaredNorm());
        return std::sqrt(squared);
    }

    /// Appends a contact, unless none of its nodes can move.
    void add(std::uint64_t feature, ContactKind contact_kind, const Stencil& stencil, const ContactGeometry& geometry) {
        for (std::size_t a = 0; a < 4; ++a)
            if (stencil.weight[a] != 0 && inputs.inverse_mass[stencil.node[a]] > 0) {
                found.push_back(contact_row(*this, feature, contact_kind, stencil, geometry));
                return;
            }
    }

    /// True if no triangle is nearer to the point of candidate c than the triangle of c. Only other candidates with
    /// this point are compared, because all triangles within `depth` of the point are candidates.
    ///
    /// `depth`: distance between the point and the triangle of c [m]. `squared(i)`: squared distance from the point to
    /// the triangle of candidate i [m^2].
    bool is_nearest(Index c, Real depth, auto&& squared) const {
        const Real limit = depth - nearer_fraction * (depth + scale.edge);
        return none_of_point(c, [&](Index i) { return limit > 0 && squared(i) < limit * limit; });
    }

    /// True if `holds(i)` is false for every other candidate i with the same point as candidate c.
    bool none_of_point(Index c, auto&& holds) const {
        const std::uint64_t group = point_of_feature(candidates[c].feature);
        const Index count = static_cast<Index>(candidates.size());
        for (Index i = c - 1; i >= 0 && point_of_feature(candidates[i].feature) == group; --i)
            if (holds(i)) return false;
        for (Index i = c + 1; i < count && point_of_feature(candidates[i].feature) == group; ++i)
            if (holds(i)) return false;
        return true;
    }
};

}  // namespace skerry
