#include "systems/collision/narrow/edge_edge_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace skerry {

namespace {

// Angle between the normals of the two faces of an edge below which the edge counts as flat [rad]. Flat edges get no
// contacts: the nodes around them keep the contact distance. Two flat edges can come nearer than this distance, by at
// most min_bend / 4 times the width of the faces: an eighth of its default (0.02 edge lengths).
constexpr Real min_bend = 0.01;

// Angle by which the contact normal may lie outside of the range between the normals of the two faces of an edge [rad]
// (docs/methods/collision.md 4.4). Wedge adds the tolerance `closing` for rotations within the step: if a contact stops
// one end of an edge, the other end moves on, and the edge could cross another edge.
//
// Example: an edge E rests on a face F, and crosses two edges A and B of F. Both contact normals equal the normal of F,
// one limit of the range. If A is flatter than B, the slack (Wedge::slack) lets E sink further at A. E is thus tilted,
// and the contact normal at B leaves the range, by about 0.01 rad for edges of equal length. Without the tolerance E
// would lose the contact at B, fall onto F and be pushed out, again and again.
constexpr Real border_angle = 3 * min_bend;

Index opposite(const std::array<Index, 3>& triangle, const std::array<Index, 2>& edge) {
    for (Index n : triangle)
        if (n != edge[0] && n != edge[1]) return n;
    return triangle[0];
}

/// Unit normal of a triangle; zero if the triangle has no area.
Vec3 unit_normal(std::span<const Vec3> position, const std::array<Index, 3>& node) {
    const Vec3 normal = (position[node[1]] - position[node[0]]).cross(position[node[2]] - position[node[0]]);
    const Real length = normal.norm();
    return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

/// The one or two faces at an edge. They determine in which directions the edge can touch another edge.
class Wedge {
public:
    /// `closing`: distance by which the two surfaces may approach in this step [m]; it is added to the tolerances of
    /// the tests. `against_axis`: true if the edge is tested against the axis of a capsule.
    Wedge(const SurfaceTables& surface, std::span<const Vec3> position, Index edge, Real closing, bool against_axis) {
        const auto& ends = surface.edges.node[edge];
        const auto& around = surface.edges.triangle[edge];
        is_axis_ = is_axis(surface, edge);
        if (is_axis_) return;
        const Vec3& origin = position[ends[0]];
        const Vec3 along = position[ends[1]] - origin;
        const auto& first = surface.triangles.node[around[0]];
        const Vec3 normal = unit_normal(position, first);
        outward_ = normal;
        into_[0] = across(along, position[opposite(first, ends)] - origin);
        border_[0] = border_angle * into_[0].norm() + closing;
        if (around[1] == no_index) {
            // At the boundary of an open surface there is only one face. The second face is replaced by a face at a
            // right angle behind the first one.
            into_[1] = -into_[0].norm() * normal;
            border_[1] = border_[0];
            convex_ = true;
            return;
        }
        const auto& second = surface.triangles.node[around[1]];
        into_[1] = across(along, position[opposite(second, ends)] - origin);
        border_[1] = border_angle * into_[1].norm() + closing;
        outward_ += unit_normal(position, second);
        // `fall`: depth of the second face below the plane of the first face [m]. It is measured at the corner of the
        // second face that is not on the edge, and is positive at a convex edge.
        const Real width = into_[0].norm(), other_width = into_[1].norm(), fall = -normal.dot(into_[1]);
        if (against_axis) {  // the axis of a capsule may also rest on flat and slightly concave edges
            convex_ = fall > -min_bend * other_width - closing;
            return;
        }
        convex_ = fall > min_bend * other_width - closing;
        // Slack at the middle of the edge (see slack()): distance by which an edge that crosses here may come nearer
        // than the contact distance. With the widths w1, w2 of the faces and the angle b between their normals, it is
        // (2 min_bend - b) w1 w2 / (w1 + w2) / 2 (docs/methods/collision.md 4.5).
        //
        // The small angle b is replaced by its sine, fall / other_width, which is equal for both orders of the faces
        // up to rounding.
        slack_ = other_width > 0 ? std::max(Real(0), 2 * min_bend - fall / other_width) * width * other_width /
                                       (width + other_width) / 2
                                 : 0;
    }

    /// True if the edge is the core of a capsule, which can be touched from all sides.
    static bool is_axis(const SurfaceTables& surface, Index edge) {
        return is_core(surface.triangles.node[surface.edges.triangle[edge][0]]);
    }

    bool convex() const { return is_axis_ || convex_; }

    /// Slack: distance by which another edge that crosses this edge at `fraction` of the length may come nearer than
    /// the contact distance [m]. It decreases towards the ends, where the faces are narrower.
    ///
    /// A flat edge gets no contact, so another edge may already be nearer when the angle between its faces reaches
    /// min_bend. Without the slack the gap would then be negative, and stacked blocks would vibrate for ever.
    Real slack(Real fraction) const { return 4 * fraction * (1 - fraction) * slack_; }

    /// True if a point in the given direction from the edge is nearer to the edge than to the two faces of the edge.
    /// `direction`: unit vector perpendicular to the edge.
    bool can_touch_along(const Vec3& direction) const {
        if (is_axis_) return true;
        // At a nearly flat edge, directions into the body are also within the limits `border_`, so the sum of the face
        // normals is tested, too.
        return direction.dot(outward_) > 0 && direction.dot(into_[0]) <= border_[0] &&
               direction.dot(into_[1]) <= border_[1];
    }

private:
    /// Component of `v` perpendicular to the edge direction `along`. If `v` is the vector from the edge to the opposite
    /// corner of a face, the length of the result is the width of the face.
    static Vec3 across(const Vec3& along, const Vec3& v) {
        const Real squared = along.squaredNorm();
        return squared > 0 ? Vec3(v - along.dot(v) / squared * along) : v;
    }

    std::array<Vec3, 2> into_;  // vectors from the edge across each face, perpendicular to the edge [m]
    // for each face: greatest scalar product of `into_` and a direction that can_touch_along() accepts [m]
    std::array<Real, 2> border_;
    Vec3 outward_;  // sum of the unit normals of both faces
    bool is_axis_ = false, convex_ = false;
    Real slack_ = 0;  // slack of a crossing at the middle of the edge [m]
};

}  // namespace

bool edge_can_touch_along(const SurfaceTables& surface, std::span<const Vec3> position, Index edge,
                          const Vec3& direction, bool nearly_flat) {
    const Wedge wedge(surface, position, edge, 0, nearly_flat);
    return wedge.convex() && wedge.can_touch_along(direction);
}

EdgeEdgeContact edge_edge_contact(const SurfaceTables& surface, std::span<const Vec3> position, Index first,
                                  Index second, const PairScale& scale, Real contact_limit, Surfaces surfaces) {
    const auto &ea = surface.edges.node[first], &eb = surface.edges.node[second];
    const Vec3 &a0 = position[ea[0]], &a1 = position[ea[1]], &b0 = position[eb[0]], &b1 = position[eb[1]];
    EdgeEdgeContact contact;
    contact.closest = closest_points_of_segments(a0, a1, b0, b1);
    const Real distance = std::sqrt(contact.closest.distance_squared);
    contact.sleep = distance - scale.edge_depth;
    if (!contact.closest.interior || !(distance <= std::max(contact_limit, scale.edge_depth))) return contact;

    // The normal is parallel to the line between the nearest points. It is computed from the directions of the edges,
    // so that it is defined even if the edges touch.
    Vec3 normal = (a1 - a0).cross(b1 - b0).normalized();
    const Real height = normal.dot(contact.closest.on_first - contact.closest.on_second);
    if (height < 0) normal = -normal;
    const Real closing = contact_limit - scale.contact_distance;
    const Wedge wedge_a(surface, position, first, closing, Wedge::is_axis(surface, second));
    if (!wedge_a.convex()) return contact;
    const Wedge wedge_b(surface, position, second, closing, Wedge::is_axis(surface, first));
    if (!wedge_b.convex()) return contact;
    if (wedge_b.can_touch_along(normal) && wedge_a.can_touch_along(-normal)) {
        contact.distance = distance;
        contact.normal = normal;
    } else if (surfaces == Surfaces::may_overlap && distance <= scale.edge_depth && wedge_b.can_touch_along(-normal) &&
               wedge_a.can_touch_along(normal)) {
        contact.distance = -distance;  // the edges have passed each other
        contact.normal = -normal;
    } else {
        return contact;
    }
    contact.touching = true;
    contact.slack =
        std::min(wedge_a.slack(contact.closest.s) + wedge_b.slack(contact.closest.t), scale.contact_distance / 2);
    return contact;
}

}  // namespace skerry
