#include "systems/collision/colliders/edge_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/collision/inputs/contact_key.h"

namespace skerry {

namespace {

// A slope of the distance along the edge below this is none: over the whole edge it changes the distance by a hundredth
// of the contact distance that bodies have by default, 0.02 of an edge.
constexpr Real flat_slope = 2e-4;

// Beyond places where the slope becomes greater than this the edge is out of reach unless it turns.
constexpr Real steep_slope = 0.05;

// The end of a flat stretch, and a minimum, are found to this fraction of the edge.
constexpr Real place_tolerance = 1e-10;

// Points nearer to each other than this fraction of the edge are one.
constexpr Real shortest_stretch = 0.1;

// The wall of a bucket is not convex: an edge across its rim has two minima. They are looked for between this many
// places.
constexpr int wall_intervals = 16;

/// The distance to the part at the places of an edge.
class Along {
public:
    Along(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b)
        : geometry_(geometry), part_(part), a_(a), edge_(b - a), length_(edge_.norm()) {}

    Real length() const { return length_; }
    SurfacePoint at(Real s) const { return local_distance(geometry_, a_ + s * edge_, part_); }
    /// Change of the distance by way along the edge; -1 to 1.
    Real slope(const SurfacePoint& found) const { return found.normal.dot(edge_) / length_; }
    Real slope(Real s) const { return slope(at(s)); }

    /// The minimum of a stretch, whose normal has no part along the edge: of a kink the one between those of its sides.
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

private:
    const ColliderGeometry& geometry_;
    const Index part_;
    const Vec3 a_, edge_;
    const Real length_;
};

/// What is on both sides of a place.
struct Bracket {
    Real low, high;
};

/// Where a rising function passes zero; `below` and `above`: its values at both ends. Along the chord, by the Illinois
/// rule: where the slope is smooth that takes a few looks in place of 33 by halves. A kink, or a stretch of one value,
/// is found by the halving of every fourth round.
Bracket close_in(Bracket on, Real below, Real above, bool zero_is_below, auto&& value_at) {
    constexpr int rounds_by_chord = 3;
    constexpr Real least_step = 0.5 * place_tolerance;  // what is found from one side is passed by this
    int same_side = 0;                                  // above zero: the last looks were below, so many
    for (int round = 0; on.high - on.low > place_tolerance; ++round) {
        Real s = 0.5 * (on.low + on.high);
        if (round % (rounds_by_chord + 1) != rounds_by_chord)
            s = std::clamp(on.low - below / (above - below) * (on.high - on.low), on.low + least_step,
                           on.high - least_step);
        const Real value = value_at(s);
        if (value < 0 || (zero_is_below && !(value > 0))) {
            on.low = s;
            below = value;
            same_side = std::max(same_side, 0) + 1;
            if (same_side > 1) above *= 0.5;
        } else {
            on.high = s;
            above = value;
            same_side = std::min(same_side, 0) - 1;
            if (same_side < -1) below *= 0.5;
        }
    }
    return on;
}

/// The points of one interval in which the slope rises.
class Stretch {
public:
    Stretch(const Along& along, Bracket interval, Index first_number, EdgeContact& contact)
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

    /// Where the distance no longer falls by more than `slope`, and where it begins to rise by more; on the flatter
    /// side of a kink, whose normal holds along the stretch.
    Real first_place(Real slope) const {
        return close_in(interval_, slope_low_ + slope, slope_high_ + slope, false,
                        [&](Real s) { return along_.slope(s) + slope; })
            .high;
    }
    Real last_place(Real slope) const {
        return close_in(interval_, slope_low_ - slope, slope_high_ - slope, true,
                        [&](Real s) { return along_.slope(s) - slope; })
            .low;
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
    /// Only where the slope is not too steep a stretch away from the other point; that is known at one look, since
    /// slopes rise.
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

    const Along& along_;
    const Bracket interval_;
    const Real slope_low_, slope_high_;
    const Index first_number_;
    EdgeContact& contact_;
};

/// Calls `visit(low, high)` for each interval in which the slope rises past one of those that count. Returns
/// edge_distance.
Real scan(const Along& along, bool convex, auto&& visit) {
    const int intervals = convex ? 1 : wall_intervals;
    Real nearest = std::numeric_limits<Real>::infinity(), low = 0;
    SurfacePoint before = along.at(0);
    for (int i = 1; i <= intervals; ++i) {
        const Real high = static_cast<Real>(i) / intervals;
        const SurfacePoint after = along.at(high);
        const Real falls = along.slope(before), rises = along.slope(after), length = along.length() / intervals;
        // Of a convex part by the tangents at both ends, of any by the length in between.
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
    return scan(Along(geometry, part, a, b), is_convex_part(geometry, part), [](Real, Real) {});
}

EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b) {
    const Along along(geometry, part, a, b);
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
