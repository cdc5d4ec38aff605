#include "systems/collision/colliders/edge_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/collision/inputs/contact_key.h"

namespace skerry {

namespace {

// The derivative of the distance along the edge counts as zero if its magnitude is at most this value. Over the length
// of an edge, such a derivative changes the distance by 1 % of the default contact distance (0.02 edge lengths).
constexpr Real flat_slope = 2e-4;

// Upper limit of the magnitude of the derivative of the distance along the edge at a contact point. Where the
// derivative is larger, the edge rises so steeply from the collider that it can touch only after it has rotated.
constexpr Real steep_slope = 0.05;

// Accuracy of the parameter of a minimum or of an end of a flat stretch (0 to 1 along the edge).
constexpr Real place_tolerance = 1e-10;

// Contact points on an edge are at least this fraction of the edge length apart. A flat stretch that is shorter gets
// one point.
constexpr Real shortest_stretch = 0.1;

// Number of intervals in which an edge near the wall of a bucket is searched. The wall is not convex, so the distance
// may have several minima, for example two along an edge across the rim. Each must be in an interval of its own.
constexpr int wall_intervals = 16;

/// An interval of the parameter along the edge. The interval contains the parameter to be found.
struct Bracket {
    Real low, high;
};

/// Distance between an edge and a part of a collider, as a function of the parameter s along the edge, from 0 to 1.
class DistanceAlongEdge {
public:
    DistanceAlongEdge(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b)
        : geometry_(geometry), part_(part), a_(a), edge_(b - a), length_(edge_.norm()) {}

    Real length() const { return length_; }
    SurfacePoint at(Real s) const { return local_distance(geometry_, a_ + s * edge_, part_); }
    /// Derivative of the distance with respect to the arc length along the edge, from -1 to 1.
    Real slope(const SurfacePoint& found) const { return found.normal.dot(edge_) / length_; }
    Real slope(Real s) const { return slope(at(s)); }

    /// Returns the midpoint of a very short interval that contains the minimum of the distance. If the distance has a
    /// kink in the interval, the normals on both sides of the kink are combined into a normal perpendicular to the
    /// edge.
    EdgePoint minimum(Real low, Real high) const {
        EdgePoint found{0, 0.5 * (low + high), at(0.5 * (low + high))};
        const SurfacePoint before = at(low), after = at(high);
        const Real falls = slope(before), rises = slope(after);
        if (std::abs(slope(found.on)) <= flat_slope || !(falls < 0 && rises > 0)) return found;
        const Vec3 normal = (rises * before.normal - falls * after.normal) / (rises - falls);
        const Real length = normal.norm();
        if (length > 0) found.on.normal = normal / length;
        return found;
    }

    /// For a box, calls visit(s) for the parameters s at which the edge crosses the planes of the sides. Between two
    /// such parameters, the nearest feature of the box stays the same, except inside the box. Does nothing for other
    /// shapes.
    void for_each_kink(auto&& visit) const {
        if (geometry_.shape != ColliderShape::box) return;
        for (int i = 0; i < 3; ++i)
            for (const Real side : {-geometry_.size[i], geometry_.size[i]}) visit((side - a_[i]) / edge_[i]);
    }

    /// Parameter s at which the derivative of the distance with respect to the arc length has the value `slope`, in
    /// closed form for a sphere or box; NaN if there is no solution, or for other shapes. For a box, the formula holds
    /// while its nearest corner, edge or side is the same as at s = `near`.
    ///
    /// Derivation: let f(s) be the distance from the centre of the sphere, or from the nearest corner, edge or side of
    /// the box, f0 its least value, at s0, and q = |along|. Then f^2 = q^2 (s - s0)^2 + f0^2, and the derivative by arc
    /// length is
    /// q^2 (s - s0) / (length f). With r = slope length, it equals `slope` at s = s0 + r f0 / (q sqrt(q^2 - r^2)).
    Real place_of(Real slope, Real near) const {
        const bool is_box = geometry_.shape == ColliderShape::box;
        if (!is_box && geometry_.shape != ColliderShape::sphere) return std::numeric_limits<Real>::quiet_NaN();
        // Start and direction of the edge relative to the origin of a sphere, or to the nearest corner, edge or side of
        // a box. For a box, coordinates along which the nearest feature extends are zero.
        Vec3 from = a_, along = edge_;
        for (int i = 0; i < 3 && is_box; ++i) {
            const Real at = a_[i] + near * edge_[i];
            const bool beyond = std::abs(at) > geometry_.size[i];
            from[i] = beyond ? from[i] - std::copysign(geometry_.size[i], at) : 0;
            along[i] = beyond ? along[i] : 0;
        }
        const Real q2 = along.squaredNorm(), s0 = -from.dot(along) / q2, reached = slope * length_;
        return s0 + reached * (from + s0 * along).norm() / std::sqrt(q2 * (q2 - reached * reached));
    }

private:
    const ColliderGeometry& geometry_;
    const Index part_;
    const Vec3 a_, edge_;
    const Real length_;
};

/// Finds the parameter s along an edge at which the derivative of the distance passes the value `slope`. The search
/// first tests the kinks and the prediction of DistanceAlongEdge::place_of, then narrows the interval by regula falsi
/// (Illinois variant). Every fourth iteration bisects, so that the search also converges at kinks and where the
/// derivative is constant.
class SlopeRoot {
public:
    /// `below` and `above`: derivatives at the lower and upper end of the interval `on`. `itself_is_below`: true if a
    /// derivative of exactly `slope` counts as below `slope`. On a stretch where the derivative has this value, the end
    /// is then found instead of the start.
    SlopeRoot(const DistanceAlongEdge& along, Bracket on, Real below, Real above, Real slope, bool itself_is_below)
        : along_(along),
          on_(on),
          below_(below - slope),
          above_(above - slope),
          slope_(slope),
          itself_is_below_(itself_is_below) {}

    Bracket find() {
        constexpr int rounds_by_chord = 3;
        along_.for_each_kink([&](Real s) { test(s); });
        const Real expected = along_.place_of(slope_, 0.5 * (on_.low + on_.high));
        test(expected - least_step);
        test(expected + least_step);
        for (int round = 0; on_.high - on_.low > place_tolerance; ++round) {
            if (round % (rounds_by_chord + 1) == rounds_by_chord)
                test(0.5 * (on_.low + on_.high));
            else
                test(std::clamp(on_.low - below_ / (above_ - below_) * (on_.high - on_.low), on_.low + least_step,
                                on_.high - least_step));
        }
        return on_;
    }

private:
    // Parameters are tested at this distance on both sides of the predicted parameter. If the two enclose the solution,
    // the interval is shorter than place_tolerance, and the search ends.
    static constexpr Real least_step = 0.45 * place_tolerance;

    /// Evaluates the derivative at `s` and shrinks the interval. Does nothing if `s` is outside of the interval.
    void test(Real s) {
        if (!(s > on_.low && s < on_.high)) return;
        const Real value = along_.slope(s) - slope_;
        const bool is_below = value < 0 || (itself_is_below_ && !(value > 0));
        (is_below ? on_.low : on_.high) = s;
        (is_below ? below_ : above_) = value;
        same_side_ = is_below == was_below_ ? same_side_ + 1 : 1;
        was_below_ = is_below;
        if (same_side_ > 1) (is_below ? above_ : below_) *= 0.5;
    }

    const DistanceAlongEdge& along_;
    Bracket on_;
    Real below_, above_;
    const Real slope_;
    const bool itself_is_below_;
    bool was_below_ = false;
    int same_side_ = 0;
};

/// Finds the contact points in an interval in which the derivative of the distance increases (edge_contact.h):
/// - the minimum, or both ends of a flat stretch, where the distance is nearly constant;
/// - the points beyond which the distance rises steeply.
class Stretch {
public:
    Stretch(const DistanceAlongEdge& along, Bracket interval, Index first_number, EdgeContact& contact)
        : along_(along),
          interval_(interval),
          slope_low_(along.slope(interval.low)),
          slope_high_(along.slope(interval.high)),
          first_number_(first_number),
          contact_(contact) {}

    void add_points() {
        const bool falls = passes(-flat_slope), rises = passes(flat_slope);
        const std::size_t none = contact_.count;
        if (falls && rises)
            add_minimum();
        else if (falls)
            add(0, first_place(flat_slope));
        else if (rises)
            add(1, last_place(flat_slope));
        const Real low = contact_.count > none ? contact_.point[none].s : 1,
                   high = contact_.count > none ? contact_.point[contact_.count - 1].s : 0;
        if (passes(-steep_slope)) add_before(low);
        if (passes(steep_slope)) add_behind(high);
    }

private:
    bool passes(Real slope) const { return slope_low_ < slope && slope_high_ > slope; }

    /// Parameter from which on the derivative of the distance is at least -`slope`. If the derivative jumps past this
    /// value at a kink, the parameter just behind the kink is returned, because the normal there is valid along the
    /// flat stretch.
    Real first_place(Real slope) const {
        return SlopeRoot(along_, interval_, slope_low_, slope_high_, -slope, false).find().high;
    }
    /// Parameter up to which the derivative of the distance is at most `slope`. If the derivative jumps past this value
    /// at a kink, the parameter just before the kink is returned, because the normal there is valid along the flat
    /// stretch.
    Real last_place(Real slope) const {
        return SlopeRoot(along_, interval_, slope_low_, slope_high_, slope, true).find().low;
    }

    void add_minimum() {
        const Real first = first_place(flat_slope), last = last_place(flat_slope);
        if (!(first < last)) {
            const EdgePoint kink = along_.minimum(last, first);
            push(0, kink.s, kink.on);
        } else if (last - first < shortest_stretch) {
            add(0, 0.5 * (first + last));
        } else {
            add(0, first);
            add(1, last);
        }
    }
    /// add_before and add_behind add the point beyond which the distance rises steeply, if it is more than
    /// shortest_stretch before or behind the contact point at `other`. The first line tests this cheaply: the
    /// derivative increases along the edge, so a distance that is too steep at this separation is even steeper further
    /// away.
    void add_before(Real other) {
        const Real last = other - shortest_stretch;
        if (last <= interval_.low || (last < interval_.high && along_.slope(last) < -steep_slope)) return;
        const Real s = first_place(steep_slope);
        if (other - s > shortest_stretch) add(2, s);
    }
    void add_behind(Real other) {
        const Real first = other + shortest_stretch;
        if (first >= interval_.high || (first > interval_.low && along_.slope(first) > steep_slope)) return;
        const Real s = last_place(steep_slope);
        if (s - other > shortest_stretch) add(3, s);
    }
    void add(Index number, Real s) { push(number, s, along_.at(s)); }
    void push(Index number, Real s, const SurfacePoint& on) {
        contact_.point[contact_.count++] = {first_number_ + number, s, on};
    }

    const DistanceAlongEdge& along_;
    const Bracket interval_;
    const Real slope_low_, slope_high_;
    const Index first_number_;
    EdgeContact& contact_;
};

/// Divides the edge into intervals of the parameter. Calls visit(low, high) for each interval in which the derivative
/// of the distance passes one of the values -steep_slope, -flat_slope, flat_slope or steep_slope. Returns a lower bound
/// of the distance between the edge and the part (edge_distance).
Real scan(const DistanceAlongEdge& along, bool convex, auto&& visit) {
    const int intervals = convex ? 1 : wall_intervals;
    Real nearest = infinity, low = 0;
    SurfacePoint before = along.at(0);
    for (int i = 1; i <= intervals; ++i) {
        const Real high = static_cast<Real>(i) / intervals;
        const SurfacePoint after = along.at(high);
        const Real falls = along.slope(before), rises = along.slope(after), length = along.length() / intervals;
        // Lower bound of the distance in the interval. For a convex part it follows from the tangents at both ends. For
        // other parts, with the distances d0 and d1 at the ends, it is (d0 + d1 - length) / 2, because the distance
        // changes by at most the length along the edge.
        const Real bound = convex ? std::max(before.distance + std::min(Real(0), falls) * length,
                                             after.distance - std::max(Real(0), rises) * length)
                                  : 0.5 * (before.distance + after.distance - length);
        nearest = std::min(nearest, bound);
        const auto passes = [&](Real slope) { return falls < slope && rises > slope; };
        if (passes(-steep_slope) || passes(-flat_slope) || passes(flat_slope) || passes(steep_slope)) visit(low, high);
        low = high;
        before = after;
    }
    return nearest;
}

}  // namespace

bool is_convex_part(const ColliderGeometry& geometry, Index part) {
    return geometry.shape != ColliderShape::bucket || part == 0;
}

Real edge_distance(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b) {
    return scan(DistanceAlongEdge(geometry, part, a, b), is_convex_part(geometry, part), [](Real, Real) {});
}

EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b) {
    const DistanceAlongEdge along(geometry, part, a, b);
    const bool convex = is_convex_part(geometry, part);
    EdgeContact contact;
    Index next = 0;
    contact.nearest = scan(along, convex, [&](Real low, Real high) {
        constexpr Index numbers = crossing_of_edge / 2;
        if (next < crossing_of_edge) Stretch(along, {low, high}, next, contact).add_points();
        next += numbers;
    });
    if (!convex) return contact;
    Real least = std::min(along.at(0).distance, along.at(1).distance);
    for (std::size_t i = 0; i < contact.count; ++i) least = std::min(least, contact.point[i].on.distance);
    contact.nearest = std::max(contact.nearest, least - flat_slope * along.length());
    return contact;
}

}  // namespace skerry
