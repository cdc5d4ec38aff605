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
#include "systems/collision/narrow/edge_edge_contact.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/pair_look.h"
#include "systems/geometry/passes_through.h"

namespace skerry {

namespace {

// Up to this fraction of the distance, faces around a place may seem to lie before it by rounding.
constexpr Real sight_slack = 1e-6;

/// Tests candidates of two bodies, one by one.
class PairContacts : PairLook {
public:
    PairContacts(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, PairTable& pairs, Index p,
                 Column<ContactRow>& found)
        : PairLook(inputs, settings, h, pairs, p, found), state_(pairs.state[p]) {}

    /// Returns the least distance of the features tested [m].
    Real run(Range range) {
        for_each_awake(range, [&](Index c) { wake(c); });
        return std::sqrt(nearest_squared_) - scale_.radii;
    }
    void run(std::span<const Index> rows) {
        for (const Index c : rows) wake(c);
    }

private:
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
        // In self-contact the point may simply be on the other side of a thin part.
        if (kind_ == PairKind::self && !was_far_at_rest(inputs_, scale_, point, corner)) return false;
        return is_nearest(c, depth, [&](Index i) {
            const auto& n = inputs_.surface.triangles.node[candidates_[i].second];
            return closest_point_on_triangle(inputs_.position[point], inputs_.position[n[0]], inputs_.position[n[1]],
                                             inputs_.position[n[2]])
                .distance_squared;
        });
    }

    /// True if this point touches the core of a round body. If an end of an axis is nearest, that end is tested against
    /// the other surface instead. Two ends are tested against each other once.
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

    /// True if a round body meets a place from behind because the other body is inside out there. A face between its
    /// core and the place would hold it off. Other faces may be nearer: it lies on many faces at once.
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
    Real nearest_squared_ = std::numeric_limits<Real>::infinity();
    Surfaces surfaces_ = Surfaces::may_overlap;
};

}  // namespace

Real look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                        PairTable& pairs, Column<ContactRow>& found) {
    if (has_cylinder(inputs, pairs, p)) return look_at_cylinder(inputs, settings, h, p, range, pairs, found);
    if (pairs.kind[p] == PairKind::collider) return look_at_collider(inputs, settings, h, p, range, pairs, found);
    return PairContacts(inputs, settings, h, pairs, p, found).run(range);
}

void look_at_candidates(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p,
                        std::span<const Index> rows, PairTable& pairs, Column<ContactRow>& found) {
    PairContacts(inputs, settings, h, pairs, p, found).run(rows);
}

}  // namespace skerry
