#include "systems/collision/colliders/edge_contact.h"

#include <algorithm>
#include <limits>

namespace skerry {

namespace {

// A slope of the distance along the edge below this is none: over the whole edge it changes the distance by a hundredth
// of the contact distance that bodies have by default, 0.02 of an edge.
constexpr Real flat_slope = 2e-4;

// The end of a flat stretch, and a minimum, are found to this fraction of the edge.
constexpr Real place_tolerance = 1e-12;

// Flat stretches shorter than this fraction of the edge are one point.
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
        EdgePoint found{0.5 * (low + high), at(0.5 * (low + high))};
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

/// `is_low` holds at `low` and below some place, and not at `high`: what is on both sides of that place.
struct Bracket {
    Real low, high;
};

Bracket close_in(Bracket on, auto&& is_low) {
    while (on.high - on.low > place_tolerance) {
        const Real middle = 0.5 * (on.low + on.high);
        (is_low(middle) ? on.low : on.high) = middle;
    }
    return on;
}

/// The distance falls at `low` and rises at `high`: adds its minimum in between.
void add_minimum(const Along& along, Real low, Real high, EdgeContact& contact) {
    while (high - low > place_tolerance) {
        const Real middle = 0.5 * (low + high), slope = along.slope(middle);
        if (slope < -flat_slope) {
            low = middle;
        } else if (slope > flat_slope) {
            high = middle;
        } else {
            // both within the stretch, where the normal is the one that holds along it
            const Real first = close_in({low, middle}, [&](Real s) { return along.slope(s) < -flat_slope; }).high;
            const Real last = close_in({middle, high}, [&](Real s) { return !(along.slope(s) > flat_slope); }).low;
            if (last - first < shortest_stretch) {
                contact.point[contact.count++] = {0.5 * (first + last), along.at(0.5 * (first + last))};
            } else {
                contact.point[contact.count++] = {first, along.at(first)};
                contact.point[contact.count++] = {last, along.at(last)};
            }
            return;
        }
    }
    contact.point[contact.count++] = along.minimum(low, high);
}

/// Calls `visit(low, high)` for each interval in which the distance falls first and then rises. Returns edge_distance.
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
        if (falls < -flat_slope && rises > flat_slope) visit(low, high);
        low = high;
        before = after;
    }
    return nearest;
}

bool is_convex(const ColliderGeometry& geometry, Index part) {
    return geometry.shape != ColliderShape::bucket || part == 0;
}

}  // namespace

Real edge_distance(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b) {
    return scan(Along(geometry, part, a, b), is_convex(geometry, part), [](Real, Real) {});
}

EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b) {
    const Along along(geometry, part, a, b);
    EdgeContact contact;
    contact.nearest = scan(along, is_convex(geometry, part), [&](Real low, Real high) {
        if (contact.count + 2 <= contact.point.size()) add_minimum(along, low, high, contact);
    });
    return contact;
}

}  // namespace skerry
