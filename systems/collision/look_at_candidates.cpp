#include "systems/collision/look_at_candidates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "systems/collision/contact_rows.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/look_at_collider.h"
#include "systems/collision/look_at_cylinder.h"
#include "systems/collision/narrow/candidate_lanes.h"
#include "systems/collision/narrow/edge_edge_contact.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/pair_look.h"
#include "systems/geometry/passes_through.h"

namespace skerry {

namespace {

// Faces around a place may seem to lie before it by rounding.
constexpr Real sight_slack = 1e-6;

/// Looks at a range of the candidates of two bodies.
class PairContacts : PairLook {
public:
    PairContacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs, Index p,
                 Column<ContactRow>& found, Column<NearCandidate>& near)
        : PairLook(inputs, settings, h, pairs, p, found),
          state_(pairs.state[p]),
          pair_(p),
          can_meet_((pairs.travel_bound[p] - pairs.travel[p]) / slow_fraction),
          meeting_(near) {}

    /// Returns the least distance of what was looked at, m.
    Real run(Range range) {
        for_each_awake(range, [&](Index c) { settings_.use_budgets ? wait(c) : wake(c); });
        wake_waiting();
        for (std::size_t l = 0; l < candidate_lanes; ++l) note_nearest(nearest_lanes_[l]);
        return std::sqrt(nearest_squared_) - scale_.radii;
    }

private:
    /// Candidates of a kind are looked at together, in their order.
    void wait(Index c) {
        const bool edges = is_edge_edge(candidates_[c].feature);
        if (waiting_count_ == waiting_.size() || edges != edges_wait_) wake_waiting();
        edges_wait_ = edges;
        waiting_[waiting_count_++] = c;
    }

    /// Puts those to sleep again that are too far or too slow to be contacts of this step, and wakes the others.
    void wake_waiting() {
        if (waiting_count_ == 0) return;
        prepare_surfaces();
        std::fill(waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_), waiting_.end(), waiting_[0]);
        const CandidateDistances found = edges_wait_ ? edge_edge_distances(inputs_, candidates_, waiting_)
                                                     : point_triangle_distances(inputs_, candidates_, waiting_);
        const Real zone = edges_wait_ ? scale_.edge_depth : scale_.zone;
        const Real8 none{}, distance = load(found.distance);
        const auto near = distance <= none + std::max(near_, zone);
        // Of surfaces that are apart nothing has come through the other.
        const auto counts = surfaces_ == Surfaces::apart ? near & within_reach(distance, load(found.speed)) : near;
        const Real8 until = travel_base_ + distance - (near ? none + scale_.edge_depth : none + zone);
        const Real8 left = counts ? none + std::numeric_limits<Real>::infinity() : distance * distance;
        nearest_lanes_ = left < nearest_lanes_ ? left : nearest_lanes_;
        Lanes<Real, candidate_lanes> asleep;
        store(until, asleep);
        for (std::size_t i = 0; i < candidate_lanes; ++i) asleep_until_[waiting_[i]] = asleep[i];
        const unsigned used = (1U << waiting_count_) - 1;
        for_each_lane(used & bits_of(distance - scale_.radii < none + can_meet_), [&](std::size_t i) {
            meeting_.push_back({pair_, waiting_[i], found.distance[i]});
        });
        for_each_lane(used & bits_of(counts), [&](std::size_t i) { wake(waiting_[i]); });
        waiting_count_ = 0;
    }

    void wake(Index c) {
        prepare_surfaces();
        if (is_edge_edge(candidates_[c].feature))
            edge_against_edge(c, candidates_[c]);
        else
            point_against_triangle(c, candidates_[c]);
    }

    void note_nearest(Real squared) { nearest_squared_ = std::min(nearest_squared_, squared); }

    void prepare_surfaces() {
        if (!prepare()) return;
        surfaces_ = is_held_apart(settings_, state_, scale_) ? Surfaces::apart : Surfaces::may_overlap;
        scale_ = pair_scale_as_known(settings_, state_, scale_);
    }

    void point_against_triangle(Index c, const Candidate& candidate) {
        const Index node = inputs_.surface.vertices.node[candidate.first];
        const PointTriangleContact contact = point_triangle_contact(
            inputs_.surface, inputs_.position, inputs_.position[node], candidate.second, scale_, near_, surfaces_);
        note_nearest(contact.closest.distance_squared);
        asleep_until_[c] = travel_base_ + contact.sleep;
        const auto& corner = inputs_.surface.triangles.node[candidate.second];
        if (contact.side == Side::none || (is_core(corner) && !core_is_touched(candidate, contact.closest))) return;
        Real speed_squared = 0;
        for (Index n : corner)
            speed_squared = std::max(speed_squared, (inputs_.velocity[node] - inputs_.velocity[n]).squaredNorm());
        if (!within_reach(contact.distance, std::sqrt(speed_squared))) return;
        if (contact.side == Side::behind) {
            const bool held = scale_.radii > 0 && surfaces_ == Surfaces::apart
                                  ? is_in_sight(c, node, contact.closest.nearest)
                                  : is_truly_behind(c, node, corner, std::abs(contact.distance));
            if (!held) return;
        }
        add(candidate, ContactKind::point_triangle,
            stencil_of_point({node, corner[0], corner[1], corner[2]}, contact.closest), contact.closest.nearest,
            contact.normal, contact.distance, scale_.contact_distance, Vec3::Zero());
    }

    /// A point behind a triangle is held by it only if no other of the body's triangles is nearer: it may be in front
    /// of the far side of a thin part, or be pushed out through a nearer face.
    bool is_truly_behind(Index c, Index point, const std::array<Index, 3>& corner, Real depth) const {
        // In a body's contact with itself it may simply be on the other side of a thin part.
        if (kind_ == PairKind::self && !was_far_at_rest(inputs_, scale_, point, corner)) return false;
        return is_nearest(c, depth, [&](Index i) {
            const auto& n = inputs_.surface.triangles.node[candidates_[i].second];
            return closest_point_on_triangle(inputs_.position[point], inputs_.position[n[0]], inputs_.position[n[1]],
                                             inputs_.position[n[2]])
                .distance_squared;
        });
    }

    /// Whether the core of a round body is touched by this point. Where an end of an axis is nearest, that is what is
    /// held against the other surface; two ends are held once.
    bool core_is_touched(const Candidate& candidate, const PointTriangle& closest) const {
        const bool turned = is_point_of_second(candidate.feature);
        const BodyTable& body = inputs_.body;
        const Index own = body.core_nodes[turned ? second_ : first_],
                    other = body.core_nodes[turned ? first_ : second_];
        const bool between = closest.region == TriangleRegion::edge01;
        if (own > 0) return between || own < other || !turned;
        const auto& [a, b, c] = inputs_.surface.triangles.node[candidate.second];
        const Vec3& point = inputs_.position[inputs_.surface.vertices.node[candidate.first]];
        return between && vertex_holds_axis(inputs_.surface, inputs_.position, candidate.first, closest.nearest - point,
                                            inputs_.position[b] - inputs_.position[a], scale_);
    }

    /// Whether a round body meets a place from behind because the other is inside out there: a face between its core
    /// and the place would hold it off. Others may be nearer: it lies on many faces at once.
    bool is_in_sight(Index c, Index core, const Vec3& place) const {
        const Vec3& from = inputs_.position[core];
        const Vec3 until = from + (1 - sight_slack) * (place - from);
        return none_of_point(c, [&](Index i) {
            const auto& n = inputs_.surface.triangles.node[candidates_[i].second];
            return passes_through(from, until, inputs_.position[n[0]], inputs_.position[n[1]], inputs_.position[n[2]]);
        });
    }

    void edge_against_edge(Index c, const Candidate& candidate) {
        const EdgeEdgeContact contact = edge_edge_contact(inputs_.surface, inputs_.position, candidate.first,
                                                          candidate.second, scale_, near_, surfaces_);
        note_nearest(contact.closest.distance_squared);
        asleep_until_[c] = travel_base_ + contact.sleep;
        if (!contact.touching) return;
        const auto &a = inputs_.surface.edges.node[candidate.first], &b = inputs_.surface.edges.node[candidate.second];
        Real speed_squared = 0;
        for (Index m : a)
            for (Index n : b)
                speed_squared = std::max(speed_squared, (inputs_.velocity[m] - inputs_.velocity[n]).squaredNorm());
        if (!within_reach(contact.distance, std::sqrt(speed_squared))) return;
        add(candidate, ContactKind::edge_edge, stencil_of_edges({a[0], a[1], b[0], b[1]}, contact.closest),
            contact.closest.on_second, contact.normal, contact.distance, scale_.contact_distance - contact.slack,
            Vec3::Zero());
    }

    const PairState state_;
    const Index pair_;
    const Real can_meet_;  // m
    Column<NearCandidate>& meeting_;
    CandidateRows waiting_;
    std::size_t waiting_count_ = 0;
    bool edges_wait_ = false;  // or points
    Real nearest_squared_ = std::numeric_limits<Real>::infinity();
    Real8 nearest_lanes_ = Real8{} + std::numeric_limits<Real>::infinity();  // the same, of what was put to sleep
    Surfaces surfaces_ = Surfaces::may_overlap;
};

}  // namespace

Real look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                        PairTable& pairs, Column<ContactRow>& found, Column<NearCandidate>& near) {
    if (has_cylinder(inputs, pairs, p)) return look_at_cylinder(inputs, settings, h, p, range, pairs, found);
    if (pairs.kind[p] == PairKind::collider) return look_at_collider(inputs, settings, h, p, range, pairs, found);
    return PairContacts(inputs, settings, h, pairs, p, found, near).run(range);
}

}  // namespace skerry
