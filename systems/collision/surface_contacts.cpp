#include "systems/collision/surface_contacts.h"

#include <algorithm>
#include <cmath>

#include "systems/collision/narrow/edge_edge_contact.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/pair_contacts.h"
#include "systems/collision/tree/box.h"
#include "systems/geometry/passes_through.h"

namespace skerry {

namespace {

// Tolerance for rounding errors in is_in_sight: the tested segment ends short of the target by this fraction of its
// length.
constexpr Real sight_slack = 1e-6;

/// Tests single candidates of two surfaces.
class CloseTest : PairContacts {
public:
    using PairContacts::PairContacts;

    /// Tests candidate c of the list, unless its features move too slowly to touch in this step. If the surfaces may
    /// overlap, slow candidates are tested, too, because their features may already have passed through each other.
    void test(Index c, const CandidateNodes& node, Real distance) {
        const FeaturePair features = features_of(candidates[c]);
        const Real speed = relative_speed(features, node);
        if (settings.use_budgets && held_apart && !within_reach(distance, speed)) return;
        if (features == FeaturePair::edge_edge)
            edge_against_edge(c, node, speed);
        else
            point_against_triangle(c, node, speed);
    }

private:
    /// Greatest relative speed between a node of the first feature and a node of the second feature [m/s].
    Real relative_speed(FeaturePair features, const CandidateNodes& node) const {
        const std::size_t own = features == FeaturePair::edge_edge ? 2 : 1;
        Real squared = 0;
        for (std::size_t m = 0; m < own; ++m)
            for (std::size_t n = own; n < 4; ++n)
                squared = std::max(squared, (inputs.velocity[node[m]] - inputs.velocity[node[n]]).squaredNorm());
        return std::sqrt(squared);
    }

    void point_against_triangle(Index c, const CandidateNodes& node, Real speed) {
        const Candidate& candidate = candidates[c];
        const PointTriangleContact contact =
            point_triangle_contact(inputs.surface, inputs.position, inputs.position[node[0]], candidate.second,
                                   known_scale_, contact_limit, surfaces_);
        asleep_until[c] = travel_base + contact.sleep;
        const auto& corner = inputs.surface.triangles.node[candidate.second];
        if (contact.side == Side::none || (is_core(corner) && !core_is_touched(candidate, contact.closest))) return;
        if (!within_reach(contact.distance, speed)) return;
        if (contact.side == Side::behind) {
            const bool is_contact = scale.radii > 0 && surfaces_ == Surfaces::apart
                                        ? is_in_sight(c, node[0], contact.closest.nearest)
                                        : is_truly_behind(c, node[0], corner, std::abs(contact.distance));
            if (!is_contact) return;
        }
        add(candidate.feature, ContactKind::point_triangle, stencil_of_point(node, contact.closest.weight),
            {contact.closest.nearest, contact.normal, contact.distance, scale.contact_distance});
    }

    void edge_against_edge(Index c, const CandidateNodes& node, Real speed) {
        const Candidate& candidate = candidates[c];
        const EdgeEdgeContact contact = edge_edge_contact(inputs.surface, inputs.position, candidate.first,
                                                          candidate.second, known_scale_, contact_limit, surfaces_);
        asleep_until[c] = travel_base + contact.sleep;
        if (!contact.touching || !within_reach(contact.distance, speed)) return;
        add(candidate.feature, ContactKind::edge_edge, stencil_of_edges(node, contact.closest),
            {contact.closest.on_second, contact.normal, contact.distance, scale.contact_distance - contact.slack});
    }

    /// True if a point behind a triangle has entered the body through this triangle, so that it must be pushed out
    /// there: no other triangle of the body is nearer. Otherwise the point has entered through the nearer triangle, or
    /// is in front of it, outside a thin part of the body.
    bool is_truly_behind(Index c, Index point, const std::array<Index, 3>& corner, Real depth) const {
        // In self-contact, a point that was near the triangle in the rest shape may be on the other side of a thin part
        // of the body.
        if (kind == PairKind::self && !was_far_at_rest(inputs, scale, point, corner)) return false;
        return is_nearest(c, depth, [&](Index i) {
            const auto& n = inputs.surface.triangles.node[candidates[i].second];
            return closest_point_on_triangle(inputs.position[point], inputs.position[n[0]], inputs.position[n[1]],
                                             inputs.position[n[2]])
                .distance_squared;
        });
    }

    /// True if `candidate`, a point and the core (axis or centre) of a round body, makes a contact. Of several
    /// candidates that describe one contact, only one makes it:
    /// - A point on a mesh counts only between the ends of the axis. At an end, the candidate of this end and a face of
    ///   the mesh makes the contact.
    /// - If the ends of two axes are nearest to each other, each end is a candidate with the other axis; the end on the
    ///   first body makes the contact.
    /// - The centre of a sphere always counts, because it is the only candidate with an axis.
    bool core_is_touched(const Candidate& candidate, const PointTriangle& closest) const {
        const bool turned = is_point_of_second(candidate.feature);
        const BodyTable& body = inputs.body;
        const Index own = body.core_nodes[turned ? second : first], other = body.core_nodes[turned ? first : second];
        const bool between = closest.region == TriangleRegion::edge01;
        if (own > 0) return between || own < other || !turned;
        const auto& [a, b, c] = inputs.surface.triangles.node[candidate.second];
        const Vec3& point = inputs.position[inputs.surface.vertices.node[candidate.first]];
        return between &&
               vertex_can_touch_axis(inputs.surface, inputs.position, candidate.first, closest.nearest - point,
                                     inputs.position[b] - inputs.position[a], scale);
    }

    /// True if no face of the other body lies between the core (axis or centre) of a round body and `target`, the
    /// surface point of the other body that the core is behind. The round body then touches inverted elements from
    /// behind.
    ///
    /// This test replaces is_truly_behind for round bodies. They touch many faces at once, so a nearer face does not
    /// exclude a contact with a further one.
    bool is_in_sight(Index c, Index core, const Vec3& target) const {
        const Vec3& start = inputs.position[core];
        const Vec3 end = start + (1 - sight_slack) * (target - start);
        return none_of_point(c, [&](Index i) {
            const auto& n = inputs.surface.triangles.node[candidates[i].second];
            return passes_through(start, end, inputs.position[n[0]], inputs.position[n[1]], inputs.position[n[2]]);
        });
    }

    const PairScale known_scale_ = pair_scale_as_known(settings, state, scale);
    const Surfaces surfaces_ = held_apart ? Surfaces::apart : Surfaces::may_overlap;
};

}  // namespace

void SurfaceContacts::add(Index p, Range range) {
    const Candidate* const list = pairs_.candidates[p].data();
    std::size_t begin = count_;
    const auto close_pair = [&] {
        if (begin < count_) pair_[pair_count_++] = {p, begin, count_};
    };
    for_each_awake(settings_, pairs_, p, range, [&](Index c) {
        if (count_ == max_candidates) {
            close_pair();
            test();
            begin = 0;
        }
        // The candidate is needed later (list_nodes). The prefetches load many candidates at the same time.
        __builtin_prefetch(list + c);
        row_[count_++] = c;
    });
    close_pair();
}

void SurfaceContacts::test() {
    list_nodes();
    measure_distances(FeaturePair::point_triangle);
    measure_distances(FeaturePair::edge_edge);
    for (std::size_t i = 0; i < pair_count_; ++i) test_pair(pair_[i]);
    count_ = pair_count_ = 0;
}

/// Lists the nodes of the collected candidates, and the indices of the candidates of each kind.
void SurfaceContacts::list_nodes() {
    for (std::size_t i = 0; i < pair_count_; ++i) {
        const Candidate* const list = pairs_.candidates[pair_[i].pair].data();
        for (std::size_t slot = pair_[i].begin; slot < pair_[i].end; ++slot) {
            const Candidate& candidate = candidate_[slot] = list[row_[slot]];
            prefetch_nodes(inputs_.surface, candidate);
        }
    }
    for (Slots& slots : slots_) slots.count = 0;
    for (std::size_t slot = 0; slot < count_; ++slot) {
        Slots& slots = slots_[static_cast<std::size_t>(features_of(candidate_[slot]))];
        slots.slot[slots.count++] = static_cast<std::uint16_t>(slot);
        node_[slot] = nodes_of(inputs_.surface, candidate_[slot]);
    }
}

void SurfaceContacts::measure_distances(FeaturePair kind) {
    const Slots& slots = slots_[static_cast<std::size_t>(kind)];
    for (std::size_t first = 0; first < slots.count; first += candidate_lanes) {
        const std::size_t used = std::min(candidate_lanes, slots.count - first);
        CandidateNodeLanes lanes;
        for (std::size_t lane = 0; lane < candidate_lanes; ++lane)
            set_lane(lanes, lane, node_[slots.slot[lane < used ? first + lane : first]]);
        const auto found = distances(kind, inputs_.position, lanes);
        for (std::size_t lane = 0; lane < used; ++lane) distance_[slots.slot[first + lane]] = found[lane];
    }
}

/// Tests those candidates of a pair that can touch if both bodies move at their greatest speeds. Appends candidates
/// whose surfaces can meet in this step to near_. Stores for each candidate the travel bound below which it needs no
/// further test (asleep_until).
void SurfaceContacts::test_pair(const CollectedPair& awake) {
    const Index p = awake.pair;
    const PairScale scale = pair_scale_as_known(settings_, pairs_.state[p],
                                                pair_scale(inputs_, pairs_.kind[p], pairs_.first[p], pairs_.second[p]));
    const Real travel_base = pair_travel_base(inputs_, pairs_, p), close_until = travel_base - scale.edge_depth,
               contact_limit = near_distance(scale, pairs_.closing[p]),
               meet_distance =
                   settings_.use_budgets ? (pairs_.travel_bound[p] - pairs_.travel[p]) / slow_fraction : infinity;
    Real* const asleep_until = pairs_.asleep_until[p].data();
    PerSlot<std::uint16_t> close, meeting;
    std::size_t close_count = 0, meeting_count = 0;
    Real smallest = smallest_distance_;
    // The loop has no branches, because their outcome would be hard to predict.
    for (std::size_t slot = awake.begin; slot < awake.end; ++slot) {
        const Real zone = features_of(candidate_[slot]) == FeaturePair::edge_edge ? scale.edge_depth : scale.zone;
        const Real distance = distance_[slot], gap = distance - scale.radii;
        const bool is_close = distance <= std::max(contact_limit, zone) || !settings_.use_budgets;
        asleep_until[row_[slot]] = distance + (is_close ? close_until : travel_base - zone);
        close[close_count] = meeting[meeting_count] = static_cast<std::uint16_t>(slot);
        close_count += is_close;
        meeting_count += gap < meet_distance;
        smallest = gap < smallest ? gap : smallest;
    }
    smallest_distance_ = smallest;
    for (std::size_t i = 0; i < meeting_count; ++i) near_.push_back({p, row_[meeting[i]], distance_[meeting[i]]});
    if (close_count == 0) return;
    CloseTest close_test(inputs_, settings_, h_, pairs_, p, found_);
    for (std::size_t i = 0; i < close_count; ++i) close_test.test(row_[close[i]], node_[close[i]], distance_[close[i]]);
}

}  // namespace skerry
