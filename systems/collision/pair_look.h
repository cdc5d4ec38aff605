// Data of a pair, of any kind, that the tests of its candidates share.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "systems/collision/contact_rows.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/lane_mask.h"

namespace skerry {

// Number of candidates whose sleep is tested together, without a branch for each.
inline constexpr Index candidates_at_once = 16;

// Another triangle counts as nearer to a point only if the difference exceeds rounding.
inline constexpr Real nearer_fraction = 1e-9;

/// Mask of the awake candidates, with a bit for each of those from `begin` on that are tested together.
inline unsigned awake_lanes(std::span<const Real> asleep_until, Index begin, Real travel_bound) {
    static_assert(candidates_at_once == 2 * element_lanes);
    const Real* const until = asleep_until.data() + begin;
    const Real8 bound = Real8{} + travel_bound, first = *reinterpret_cast<const Real8InMemory*>(until),
                second = *reinterpret_cast<const Real8InMemory*>(until + element_lanes);
    return bits_of(~(bound < first)) | bits_of(~(bound < second)) << element_lanes;
}

/// Calls `wake` for each awake candidate of a range, in order.
void for_each_awake(std::span<const Real> asleep_until, Range range, Real travel_bound, auto&& wake) {
    Index c = range.begin;
    for (; c + candidates_at_once <= range.end; c += candidates_at_once)
        for_each_lane(awake_lanes(asleep_until, c, travel_bound),
                      [&](std::size_t l) { wake(c + static_cast<Index>(l)); });
    for (; c < range.end; ++c)
        if (!(travel_bound < asleep_until[static_cast<std::size_t>(c)])) wake(c);
}

/// Distance up to which features get a close test, if the pair closes by `closing` in this step [m].
inline Real nearness(const PairScale& scale, Real closing) {
    return scale.contact_distance + (closing >= 0 ? closing : 0);
}

/// Contact tests of one pair in one step. Contacts are appended to a list.
class PairLook {
public:
    PairLook(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs, Index p,
             Column<ContactRow>& found)
        : inputs_(inputs),
          settings_(settings),
          h_(h),
          key_(pairs.key[p]),
          kind_(pairs.kind[p]),
          first_(pairs.first[p]),
          second_(pairs.second[p]),
          closing_(pairs.closing[p]),
          travel_bound_(pairs.travel_bound[p]),
          travel_base_(pair_travel_base(inputs, pairs, p)),
          candidates_(pairs.candidates[p].span()),
          asleep_until_(pairs.asleep_until[p].span()),
          found_(found) {}

protected:
    /// Calls `wake` for each awake candidate of a range; without budgets for all of them.
    void for_each_awake(Range range, auto&& wake) const {
        if (settings_.use_budgets) {
            skerry::for_each_awake(asleep_until_, range, travel_bound_, wake);
            return;
        }
        for (Index c = range.begin; c < range.end; ++c) wake(c);
    }

    /// Computes the data that all candidates of the pair share, once one is awake. Returns false if it was there
    /// already.
    bool prepare() {
        if (prepared_) return false;
        scale_ = pair_scale(inputs_, kind_, first_, second_);
        surface_ = pair_surface(inputs_, kind_, first_, second_);
        near_ = nearness(scale_, closing_);
        return prepared_ = true;
    }

    bool within_reach(Real distance, Real relative_speed) const {
        const Real gap = distance - scale_.contact_distance;
        return gap <= reach(h_, relative_speed, settings_.gravity, scale_.shell);
    }

    void add(const Candidate& candidate, ContactKind kind, const Stencil& stencil, const Vec3& point,
             const Vec3& normal, Real distance, Real contact_distance, const Vec3& surface_velocity) {
        if (!moves(stencil)) return;
        ContactRow row = contact_row(inputs_, {key_, kind_, first_, second_}, candidate, kind, stencil, point, normal,
                                     distance, contact_distance, surface_);
        row.surface_velocity = surface_velocity;
        found_.push_back(row);
    }

    void add(const ContactRow& row) {
        if (moves(row.stencil)) found_.push_back(row);
    }

    /// True if no other triangle among the candidates of the same point is nearer than `depth`: all triangles as near
    /// are candidates, side by side in the list. `squared(i)`: squared distance of the point of candidate c to the
    /// triangle of candidate i.
    bool is_nearest(Index c, Real depth, auto&& squared) const {
        const Real limit = depth - nearer_fraction * (depth + scale_.edge);
        return none_of_point(c, [&](Index i) { return limit > 0 && squared(i) < limit * limit; });
    }

    /// True if `holds` is false for every other candidate of the point of candidate c.
    bool none_of_point(Index c, auto&& holds) const {
        const std::uint64_t group = point_of_feature(candidates_[c].feature);
        const Index count = static_cast<Index>(candidates_.size());
        for (Index i = c - 1; i >= 0 && point_of_feature(candidates_[i].feature) == group; --i)
            if (holds(i)) return false;
        for (Index i = c + 1; i < count && point_of_feature(candidates_[i].feature) == group; ++i)
            if (holds(i)) return false;
        return true;
    }

    const CollisionInputs& inputs_;
    const CollisionSettings& settings_;
    const Real h_;
    const std::uint64_t key_;
    const PairKind kind_;
    const Index first_, second_;
    const Real closing_, travel_bound_, travel_base_;
    std::span<const Candidate> candidates_;
    std::span<Real> asleep_until_;
    PairScale scale_;
    Real near_ = 0;
    SurfaceProperties surface_;

private:
    bool moves(const Stencil& stencil) const {
        for (std::size_t a = 0; a < 4; ++a)
            if (stencil.weight[a] != 0 && inputs_.inverse_mass[stencil.node[a]] > 0) return true;
        return false;
    }

    Column<ContactRow>& found_;
    bool prepared_ = false;
};

}  // namespace skerry
