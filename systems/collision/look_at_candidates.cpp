#include "systems/collision/look_at_candidates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "systems/collision/contact_rows.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/narrow/candidate_lanes.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/narrow/edge_edge_contact.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/collision/narrow/rest_distance.h"

namespace skerry {

namespace {

// Candidates whose sleep is tested together, without a branch for each.
constexpr Index candidates_at_once = 16;

// Another triangle is nearer to a point only if it is by more than rounding.
constexpr Real nearer_fraction = 1e-9;

/// Looks at a range of the candidates of one pair.
class PairContacts {
public:
    PairContacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs, Index p,
                 Column<ContactRow>& found)
        : inputs_(inputs),
          settings_(settings),
          h_(h),
          key_(pairs.key[p]),
          kind_(pairs.kind[p]),
          first_(pairs.first[p]),
          second_(pairs.second[p]),
          apart_(pairs.state[p] == PairState::apart && settings.continuous),
          closing_(pairs.closing[p]),
          travel_bound_(pairs.travel_bound[p]),
          travel_base_(pair_travel_base(inputs, pairs, p)),
          candidates_(pairs.candidates[p].span()),
          asleep_until_(pairs.asleep_until[p].span()),
          found_(found) {}

    /// Returns the least distance of the features that were looked at, m.
    Real run(Range range) {
        for (Index i = range.begin; i < range.end; i += candidates_at_once) {
            const Index stop = std::min(i + candidates_at_once, range.end);
            if (settings_.use_budgets && all_asleep(i, stop)) continue;
            for (Index c = i; c < stop; ++c) {
                if (!settings_.use_budgets)
                    wake(c);
                else if (!(travel_bound_ < asleep_until_[c]))
                    wait(c);
            }
        }
        wake_waiting();
        return std::sqrt(nearest_squared_);
    }

private:
    bool all_asleep(Index begin, Index end) const {
        const Real* const until = asleep_until_.data();
        bool awake = false;
#pragma omp simd reduction(| : awake)
        for (Index i = begin; i < end; ++i) awake |= !(travel_bound_ < until[i]);
        return !awake;
    }

    /// Candidates of a kind are looked at together, in their order.
    void wait(Index c) {
        if (kind_ == PairKind::collider) return wake(c);
        const bool edges = is_edge_edge(candidates_[c].feature);
        if (waiting_count_ == waiting_.size() || edges != edges_wait_) wake_waiting();
        edges_wait_ = edges;
        waiting_[waiting_count_++] = c;
    }

    /// Puts those to sleep again that are too far or too slow to be contacts of this step, and wakes the others.
    void wake_waiting() {
        if (waiting_count_ == 0) return;
        if (!prepared_) prepare();
        std::fill(waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_), waiting_.end(), waiting_[0]);
        const CandidateDistances found = edges_wait_ ? edge_edge_distances(inputs_, candidates_, waiting_)
                                                     : point_triangle_distances(inputs_, candidates_, waiting_);
        const Real zone = edges_wait_ ? scale_.edge_depth : scale_.zone;
        for (std::size_t i = 0; i < waiting_count_; ++i) {
            const Real distance = found.distance[i];
            const bool far = !(distance <= std::max(near_, zone));
            // Of surfaces that are apart nothing has come through the other.
            const bool out_of_reach =
                surfaces_ == Surfaces::apart && (found.behind >> i & 1) == 0 && !within_reach(distance, found.speed[i]);
            if (!far && !out_of_reach) {
                wake(waiting_[i]);
                continue;
            }
            nearest_squared_ = std::min(nearest_squared_, distance * distance);
            asleep_until_[waiting_[i]] = travel_base_ + distance - (far ? zone : scale_.edge_depth);
        }
        waiting_count_ = 0;
    }

    void wake(Index c) {
        if (!prepared_) prepare();
        const Candidate& candidate = candidates_[c];
        if (kind_ == PairKind::collider)
            point_against_collider(c, candidate);
        else if (is_edge_edge(candidate.feature))
            edge_against_edge(c, candidate);
        else
            point_against_triangle(c, candidate);
    }

    /// What all candidates of the pair share, once one is awake.
    void prepare() {
        scale_ = pair_scale(inputs_, kind_, first_, second_);
        surface_ = pair_surface(inputs_, kind_, first_, second_);
        // Without a shell touching surfaces may overlap by rounding.
        surfaces_ = apart_ && scale_.contact_distance > 0 ? Surfaces::apart : Surfaces::may_overlap;
        near_ = scale_.contact_distance + (closing_ >= 0 ? closing_ : 0);
        prepared_ = true;
    }

    bool within_reach(Real distance, Real relative_speed) const {
        const Real gap = distance - scale_.contact_distance;
        return gap <= reach(h_, relative_speed, settings_.gravity, scale_.contact_distance);
    }

    bool moves(const Stencil& stencil) const {
        for (std::size_t a = 0; a < 4; ++a)
            if (stencil.weight[a] != 0 && inputs_.inverse_mass[stencil.node[a]] > 0) return true;
        return false;
    }

    void add(const Candidate& candidate, ContactKind kind, const Stencil& stencil, const Vec3& point,
             const Vec3& normal, Real distance, Real contact_distance, const Vec3& surface_velocity) {
        if (!moves(stencil)) return;
        ContactRow row = contact_row(inputs_, {key_, kind_, first_, second_}, candidate, kind, stencil, point, normal,
                                     distance, contact_distance, surface_);
        row.surface_velocity = surface_velocity;
        found_.push_back(row);
    }

    void point_against_collider(Index c, const Candidate& candidate) {
        const Index node = inputs_.surface.vertices.node[candidate.first];
        const RigidMotion& motion = inputs_.collider.motion[candidate.second];
        const SurfacePoint nearest = distance_to_collider_part(inputs_.collider.geometry[candidate.second], motion,
                                                               second_local(candidate.feature), inputs_.position[node]);
        asleep_until_[c] = travel_base_ + nearest.distance - scale_.contact_distance;
        if (!(nearest.distance <= near_)) return;
        const Vec3 velocity = motion.velocity + motion.angular_velocity.cross(nearest.point - motion.position);
        if (!within_reach(nearest.distance, (inputs_.velocity[node] - velocity).norm())) return;
        add(candidate, ContactKind::point_collider, {{node, node, node, node}, {1, 0, 0, 0}}, nearest.point,
            nearest.normal, nearest.distance, scale_.contact_distance, velocity);
    }

    void point_against_triangle(Index c, const Candidate& candidate) {
        const Index node = inputs_.surface.vertices.node[candidate.first];
        const PointTriangleContact contact = point_triangle_contact(
            inputs_.surface, inputs_.position, inputs_.position[node], candidate.second, scale_, near_, surfaces_);
        nearest_squared_ = std::min(nearest_squared_, contact.closest.distance_squared);
        asleep_until_[c] = travel_base_ + contact.sleep;
        if (contact.side == Side::none) return;
        const auto& corner = inputs_.surface.triangles.node[candidate.second];
        Real speed_squared = 0;
        for (Index n : corner)
            speed_squared = std::max(speed_squared, (inputs_.velocity[node] - inputs_.velocity[n]).squaredNorm());
        if (!within_reach(contact.distance, std::sqrt(speed_squared))) return;
        if (contact.side == Side::behind && !is_truly_behind(c, node, corner, std::abs(contact.distance))) return;
        add(candidate, ContactKind::point_triangle,
            stencil_of_point({node, corner[0], corner[1], corner[2]}, contact.closest), contact.closest.nearest,
            contact.normal, contact.distance, scale_.contact_distance, Vec3::Zero());
    }

    /// A point behind a triangle is held by it only if no other of the body's triangles is nearer: it may be in front
    /// of the far side of a thin part, or be pushed out through a nearer face. All triangles as near as that are
    /// candidates of the same point, in one row.
    bool is_truly_behind(Index c, Index point, const std::array<Index, 3>& corner, Real depth) const {
        // In a body's contact with itself it may simply be on the other side of a thin part.
        if (kind_ == PairKind::self && !was_far_at_rest(inputs_, scale_, point, corner)) return false;
        const std::uint64_t group = point_of_feature(candidates_[c].feature);
        const Index count = static_cast<Index>(candidates_.size());
        const Real limit = depth - nearer_fraction * (depth + scale_.edge);
        const auto nearer = [&](Index i) {
            const auto& n = inputs_.surface.triangles.node[candidates_[i].second];
            const PointTriangle other = closest_point_on_triangle(inputs_.position[point], inputs_.position[n[0]],
                                                                  inputs_.position[n[1]], inputs_.position[n[2]]);
            return limit > 0 && other.distance_squared < limit * limit;
        };
        for (Index i = c - 1; i >= 0 && point_of_feature(candidates_[i].feature) == group; --i)
            if (nearer(i)) return false;
        for (Index i = c + 1; i < count && point_of_feature(candidates_[i].feature) == group; ++i)
            if (nearer(i)) return false;
        return true;
    }

    void edge_against_edge(Index c, const Candidate& candidate) {
        const EdgeEdgeContact contact = edge_edge_contact(inputs_.surface, inputs_.position, candidate.first,
                                                          candidate.second, scale_, near_, surfaces_);
        nearest_squared_ = std::min(nearest_squared_, contact.closest.distance_squared);
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

    const CollisionInputs& inputs_;
    const CollisionSettings& settings_;
    const Real h_;
    const std::uint64_t key_;
    const PairKind kind_;
    const Index first_, second_;
    const bool apart_;
    const Real closing_, travel_bound_, travel_base_;
    std::span<const Candidate> candidates_;
    std::span<Real> asleep_until_;
    Column<ContactRow>& found_;
    CandidateRows waiting_;
    std::size_t waiting_count_ = 0;
    bool edges_wait_ = false;  // or points
    Real nearest_squared_ = std::numeric_limits<Real>::infinity();
    bool prepared_ = false;
    Surfaces surfaces_ = Surfaces::may_overlap;
    PairScale scale_;
    SurfaceProperties surface_;
    Real near_ = 0;
};

}  // namespace

Real look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                        PairTable& pairs, Column<ContactRow>& found) {
    return PairContacts(inputs, settings, h, pairs, p, found).run(range);
}

}  // namespace skerry
