#include "systems/collision/find_crossings.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "jobs/parallel_for.h"
#include "systems/collision/contact_rows.h"
#include "systems/collision/cylinders/rigid_cylinder.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/narrow/candidate_lanes.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/pair_crossings.h"
#include "systems/collision/search/self_motion.h"
#include "systems/geometry/closest_points.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

namespace {

// Number of pairs that one task tests with is_beyond_list().
constexpr std::size_t checked_pairs_per_block = 512;

/// Nearest points of two features at some time within the step.
struct NearestPoints {
    Stencil stencil;
    Vec3 offset;  // vector from the point on the second feature to the point on the first feature [m]
    Vec3 point;   // nearest point of the second feature [m]
};

// Upper bound of the relative difference between the distances in NearCandidate, computed by vector code, and those
// computed by the scalar code here, which rounds differently. The actual difference is much smaller.
constexpr Real lane_rounding = 1e-6;

/// Tests candidates of two surfaces for crossings.
class SurfaceCrossings : PairCrossings {
public:
    SurfaceCrossings(const PairCrossings& pair, std::span<const Real> asleep_until)
        : PairCrossings(pair), asleep_until_(asleep_until) {}

    /// Tests the candidates of a range. `travel_bound`: upper bound of the travel of the pair at the end of this step
    /// [m]. Candidates with a larger asleep_until are skipped, because their features cannot meet. Returns the number
    /// of tested candidates.
    std::uint64_t run(Range range, Real travel_bound) {
        return count_tested(asleep_until_, range, travel_bound,
                            [&](Index c) { return test(candidates[c], asleep_until_[c] - travel); });
    }

    /// Tests the candidates that find_contacts has listed as near. No crossing is missed as long as the partners
    /// approach each other by no more than find_contacts assumed (travel_bound at most PairTable::travel_bound).
    /// `reach`: upper bound of the relative motion of the partners in the step [m].
    std::uint64_t run(std::span<const NearCandidate> near, Real reach, Real travel_bound) {
        std::uint64_t tested = 0;
        for (const NearCandidate& at : near)
            if (reach > slow_fraction * (at.distance - scale.radii) && !(travel_bound < asleep_until_[at.candidate]))
                tested += test(candidates[at.candidate], (1 - lane_rounding) * at.distance - scale.radii);
        return tested;
    }

private:
    /// Tests one candidate. `min_distance`: lower bound of the distance between the surfaces [m]. For a round body,
    /// whose feature is its core (centre or axis), the surface is nearer than the feature. Returns true if a full test
    /// was needed.
    bool test(const Candidate& candidate, Real min_distance) {
        const FeaturePair features = features_of(candidate);
        const CandidateNodes node = nodes_of(inputs.surface, candidate);
        FourPoints x, displacement;
        for (std::size_t i = 0; i < 4; ++i) displacement[i] = motion.displacement(node[i]);
        const Real approach = greatest_approach(features, displacement);
        if (!(approach > slow_fraction * min_distance) || !can_move(node)) return false;
        for (std::size_t i = 0; i < 4; ++i) x[i] = inputs.position[node[i]];
        const Real distance = nearest(features, node, x).offset.norm();
        // If the surface of a round body already overlaps another surface, only a crossing of the core (centre or axis)
        // of the body is prevented.
        const ContactThreshold threshold = distance > scale.radii ? threshold_of_radii(scale) : ContactThreshold{};
        if (!(approach > slow_fraction * (distance - threshold.distance))) return false;
        const std::optional<Real> time = time_of_contact(features, x, displacement, threshold);
        if (!time || is_near_at_rest(features, node)) return true;
        FourPoints at_contact;
        for (std::size_t i = 0; i < 4; ++i) at_contact[i] = x[i] + *time * displacement[i];
        add(candidate, features, nearest(features, node, at_contact));
        return true;
    }

    bool is_near_at_rest(FeaturePair features, const CandidateNodes& node) const {
        if (kind != PairKind::self) return false;
        return features == FeaturePair::edge_edge
                   ? !was_far_at_rest(inputs, scale, std::array{node[0], node[1]}, std::array{node[2], node[3]})
                   : !was_far_at_rest(inputs, scale, node[0], std::array{node[1], node[2], node[3]});
    }

    static NearestPoints nearest(FeaturePair features, const CandidateNodes& node, const FourPoints& x) {
        if (features == FeaturePair::edge_edge) {
            const SegmentSegment c = closest_points_of_segments(x[0], x[1], x[2], x[3]);
            return {stencil_of_edges(node, c), c.on_first - c.on_second, c.on_second};
        }
        const PointTriangle c = closest_point_on_triangle(x[0], x[1], x[2], x[3]);
        return {stencil_of_point(node, c.weight), x[0] - c.nearest, c.nearest};
    }

    void add(const Candidate& candidate, FeaturePair features, const NearestPoints& at_contact) {
        const Real length = at_contact.offset.norm();
        if (!(length > 0)) return;  // the features touch already at the start of the step, so they have no normal
        const Vec3 normal = at_contact.offset / length;
        Real along = 0;  // distance of the two nearest points along the normal, at the start of the step [m]
        for (std::size_t a = 0; a < 4; ++a)
            along += at_contact.stencil.weight[a] * normal.dot(inputs.position[at_contact.stencil.node[a]]);
        // `along` is measured at the start of the step, but along the normal at the time of contact. If the features
        // have rotated by more than a right angle in between, it can be negative although nothing overlapped at the
        // start.
        found.push_back(contact_row(
            *this, candidate.feature,
            features == FeaturePair::edge_edge ? ContactKind::edge_edge : ContactKind::point_triangle,
            at_contact.stencil, {at_contact.point, normal, std::max(along, scale.radii), scale.contact_distance}));
    }

    std::span<const Real> asleep_until_;
};

/// Upper bounds of the relative motion of a pair in this step.
struct PairReach {
    Real motion;        // relative motion of the two partners in this step [m]
    Real travel_bound;  // travel of the pair at the end of this step [m]
};

/// Distance from the origin of a collider to its furthest point that can touch the body [m]. For a plane, this is the
/// distance from the origin to the furthest node of the body.
Real collider_extent(const CollisionInputs& inputs, Index body, Index collider) {
    const ColliderGeometry& geometry = inputs.collider.geometry[collider];
    if (geometry.shape != ColliderShape::plane) return collider_radius(geometry);
    Range nodes = inputs.body.nodes[body];
    if (is_cylinder(inputs, body))
        return (inputs.position[nodes.begin] - inputs.collider.motion[collider].position).norm() +
               inputs.body.round_radius[body];
    if (inputs.body.round_radius[body] > 0) nodes.end = nodes.begin + inputs.body.core_nodes[body];
    Real furthest = 0;
    for (Index n = nodes.begin; n < nodes.end; ++n)
        furthest = std::max(furthest, (inputs.position[n] - inputs.collider.motion[collider].position).norm());
    return furthest;
}

PairReach reach_of(const CollisionInputs& inputs, const PairTable& pairs, Index p, Real h) {
    const BodyTable& body = inputs.body;
    const Index a = pairs.first[p], b = pairs.second[p];
    if (pairs.kind[p] == PairKind::collider) {
        const RigidMotion& collider = inputs.collider.motion[b];
        const Real turning = collider.angular_velocity.norm(),
                   rim_speed = turning > 0 ? turning * collider_extent(inputs, a, b) : 0;
        const Real motion =
            h * (body.frame_speed[a] + body.frame[a].velocity.norm() + collider.velocity.norm() + rim_speed);
        return {motion, pairs.travel[p] + motion};
    }
    const Real motion =
        h * (body.frame_speed[a] + body.frame_speed[b] + (body.frame[a].velocity - body.frame[b].velocity).norm());
    return {motion, pairs.travel[p] + motion};
}

bool is_watched(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return (pairs.kind[p] == PairKind::collider || pairs.state[p] == PairState::apart) &&
           pair_scale(inputs, pairs.kind[p], pairs.first[p], pairs.second[p]).contact_distance > 0;
}

/// Returns the entries of `near` that belong to pair p. `near` lists the candidates of one block that could meet in
/// this step, in pair order. `next`: index of the first entry that no earlier call has passed.
std::span<const NearCandidate> take_near(std::span<const NearCandidate> near, Index p, std::size_t& next) {
    while (next < near.size() && near[next].pair < p) ++next;
    const std::size_t first = next;
    while (next < near.size() && near[next].pair == p) ++next;
    return near.subspan(first, next - first);
}

/// Tests the candidates of one block for crossings, and returns the number of tested candidates. For two surfaces, only
/// near candidates (PairTable::near) are tested, unless `use_budgets` is false or the pair moves further than
/// find_contacts assumed. `known`: crossings found by earlier attempts at this step.
std::uint64_t test_block(const CollisionInputs& inputs, bool use_budgets, const StepMotion& motion,
                         const PairTable& pairs, std::size_t b, std::span<const ContactRow> known,
                         Column<ContactRow>& found) {
    const CandidateIndex begin = pairs.block[b], end = pairs.block[b + 1];
    std::uint64_t tested = 0;
    std::size_t next = 0;
    for (Index p = begin.pair; p < static_cast<Index>(pairs.size()) && p <= end.pair; ++p) {
        const Index from = p == begin.pair ? begin.candidate : 0;
        const Index to = p == end.pair ? end.candidate : static_cast<Index>(pairs.candidates[p].size());
        if (from >= to) continue;
        const PairReach reach = reach_of(inputs, pairs, p, motion.h);
        // Candidates that find_contacts has tested have a distance of at least block_nearest, so a motion below
        // slow_fraction * block_nearest cannot make them meet. Candidates that find_contacts skipped have gaps that the
        // motion cannot close, as long as the travel stays below the travel_bound of find_contacts.
        const bool within_bound = reach.travel_bound <= pairs.travel_bound[p];
        const bool slow = reach.motion <= slow_fraction * pairs.block_nearest[b] && within_bound;
        if (slow || !is_watched(inputs, pairs, p)) continue;
        if (has_cylinder(inputs, pairs, p))
            tested += find_cylinder_crossings(inputs, motion, pairs, p, {from, to}, reach.travel_bound, known, found);
        else if (pairs.kind[p] == PairKind::collider)
            tested += find_collider_crossings(inputs, motion, pairs, p, {from, to}, reach.travel_bound, found);
        else if (within_bound && use_budgets)
            tested += SurfaceCrossings({inputs, motion, pairs, p, found}, pairs.asleep_until[p].span())
                          .run(take_near(pairs.near[b].span(), p, next), reach.motion, reach.travel_bound);
        else
            tested += SurfaceCrossings({inputs, motion, pairs, p, found}, pairs.asleep_until[p].span())
                          .run({from, to}, reach.travel_bound);
    }
    return tested;
}

/// True if a pair moves further in this step than its candidate list allows.
bool is_beyond_list(const CollisionInputs& inputs, const CollisionSettings& settings, const StepMotion& motion, Index p,
                    PairTable& pairs) {
    if (pairs.kind[p] != PairKind::collider && pairs.state[p] != PairState::apart) return false;
    // A candidate list is valid up to the travel T - 2 d0 + m, with the travel T and the displacement d0 at the search,
    // and its margin m. If the list was made from the positions of this step, nothing has moved since then. It is valid
    // up to T + m, so 2 d0 is added.
    const Real drifted =
        pairs.rebuilt[p] ? 2 * pair_displacement(inputs, pairs.kind[p], pairs.first[p], pairs.second[p]) : 0;
    if (reach_of(inputs, pairs, p, motion.h).travel_bound < pairs.valid_until[p] + drifted) return false;
    if (pairs.kind[p] != PairKind::self || !(pairs.valid_until[p] > -infinity)) return true;
    const SelfMotion self_motion = self_motion_of(inputs, settings, pairs.state[p], pairs.first[p], motion.h);
    // Beyond valid_until, find_candidates keeps a list only if the spare distances of its pairs of leaves
    // (self_motion.h) exceed the motion that follows from the present velocities (is_valid). They suffice if the nodes
    // have moved as these velocities predict.
    const bool within_reach = !(pairs.travel_bound[p] < pairs.valid_until[p]) && moves_as_expected(self_motion, motion);
    return !within_reach && !holds_for_motion(self_motion, motion, pairs.leaf_pairs[p].listed.span(), pairs.self);
}

/// True if any pair moves further in this step than its candidate list allows. This happens almost never.
bool any_beyond_list(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings,
                     const StepMotion& motion, PairTable& pairs) {
    std::atomic<bool> any{false};
    parallel_for(executor, pairs.size(), checked_pairs_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p)
            if (is_beyond_list(inputs, settings, motion, static_cast<Index>(p), pairs))
                any.store(true, std::memory_order_relaxed);
    });
    return any;
}

/// Requests longer candidate lists for the pairs that move further than their lists allow. Returns the number of
/// requests. `not_extended` counts the pairs without a request:
/// - `allowed` is false;
/// - the motion is not finite; or
/// - the list was already made in this step for a motion at least as long.
Index extend_lists(const CollisionInputs& inputs, const CollisionSettings& settings, const StepMotion& motion,
                   bool allowed, PairTable& pairs, Index& not_extended) {
    Index count = 0;
    for (Index p = 0; p < static_cast<Index>(pairs.size()); ++p) {
        if (!is_beyond_list(inputs, settings, motion, p, pairs)) continue;
        const Real length = reach_of(inputs, pairs, p, motion.h).motion;
        const bool already_extended = pairs.rebuilt[p] && length <= -pairs.longer_motion[p];
        if (already_extended || !allowed || !std::isfinite(length)) {
            ++not_extended;
            continue;
        }
        pairs.longer_motion[p] = length;
        pairs.valid_until[p] = -infinity;
        ++count;
    }
    return count;
}

void let_through(const CrossingTable& crossings, PairTable& pairs) {
    for (const auto& found : crossings.found)
        for (const ContactRow& row : found) {
            const auto at = std::lower_bound(pairs.key.begin(), pairs.key.end(), row.key.pair);
            const auto p = static_cast<std::size_t>(at - pairs.key.begin());
            // A pair with a collider has no state: the signed distance from the collider shows whether they overlap.
            if (pairs.kind[p] == PairKind::collider) continue;
            pairs.state[p] = PairState::overlapping;
            pairs.valid_until[p] = -infinity;  // an overlapping pair needs a list with a larger search distance
        }
}

}  // namespace

Index find_crossings(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                     std::span<const Vec3> velocity_next, std::span<const Vec3> push_out, PairTable& pairs,
                     CrossingTable& crossings) {
    const std::size_t blocks = pairs.block.size() > 0 ? pairs.block.size() - 1 : 0;
    crossings.beyond_lists = false;
    crossings.found_count = 0;
    if (!settings.continuous) return 0;
    Index not_extended = 0;
    const StepMotion motion{velocity_next, push_out, h};
    const Index extended = any_beyond_list(executor, inputs, settings, motion, pairs)
                               ? extend_lists(inputs, settings, motion, crossings.extends_lists, pairs, not_extended)
                               : 0;
    if (extended > 0) {
        crossings.beyond_lists = true;
        return extended;
    }
    if (blocks == 0) return crossings.last_attempt ? 0 : not_extended;
    if (crossings.found.size() < blocks) crossings.found.resize(blocks);
    std::atomic<std::uint64_t> tested{0};
    for (auto& found : crossings.found) found.clear();
    parallel_for(executor, blocks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            tested += test_block(inputs, settings.use_budgets, motion, pairs, b, crossings.row, crossings.found[b]);
    });
    crossings.tested += tested;
    for (const auto& found : crossings.found) crossings.found_count += found.size();
    return crossings.last_attempt ? 0 : static_cast<Index>(crossings.found_count) + not_extended;
}

void use_crossings(PairTable& pairs, CrossingTable& crossings) {
    if (crossings.last_attempt) {
        let_through(crossings, pairs);
        crossings.let_through += crossings.found_count;
        return;
    }
    crossings.hits += crossings.found_count;
    merge_rows(crossings.found, crossings.row, true, crossings.merged);
    crossings.row.swap(crossings.merged);
}

}  // namespace skerry
