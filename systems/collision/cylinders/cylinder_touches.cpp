#include "systems/collision/cylinders/cylinder_touches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "systems/collision/colliders/edge_contact.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/narrow/rigid_frame.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

// Angle between an end of the cylinder and a flat side of another shape below which eight points fixed to the cylinder
// support the end (RimPoints) [rad]. The direction of such a small tilt is only noise: points that depend on it would
// jump along the rim of a cylinder at rest.
constexpr Real standing_tilt = 1e-4;
// If the sine of the angle between an end of the cylinder and a flat side of another shape exceeds this limit, only one
// point of the rim of this end can touch the side.
constexpr Real lying_sine = 0.5;
// Angle by which a contact normal at an edge or rim may be outside of the range between the normals of the two adjacent
// sides [rad]. Capsules have an equal tolerance (axis_tilt in point_triangle_contact.cpp).
constexpr Real rim_angle = 0.03;
// Tolerance of nearest_region(), which classifies the gradient of the distance from the cylinder. The nearest part is
// - an end, if the component perpendicular to the axis is at most this value;
// - the curved side, if the component along the axis is at most this value.
constexpr Real gradient_rounding = 1e-9;
// Tolerance at the border of a flat side, as a fraction of the size of the side. Points that rounding errors put beside
// a side thus count as above the side.
constexpr Real over_fraction = 1e-9;
// The distance along a rim counts as constant at a point if the magnitude of its derivative is at most this value.
constexpr Real level_slope = 1e-9;
// Number of samples on a rim. Minima are searched between adjacent samples.
constexpr int samples_around = 16;
// Accuracy of the angle of a contact point on a rim, and distance below which two minima count as one [rad].
constexpr Real turn_tolerance = 1e-12, same_angle = 1e-6;

// Numbers of the contact points on a shape: numbers_per_rim for each rim, numbers_per_side for each flat side. Points
// on the rims of the cylinder come first, from 0. The other constants are the first numbers on the rims, flat sides,
// corners and edges of the other shape, and between curved sides.
constexpr Index numbers_per_rim = 8, first_on_other_rims = 16, first_on_sides = 40, numbers_per_side = 16,
                first_at_corners = 136, first_on_edges = 144, first_between_round_sides = 240;

Vec3 rim_point(Real radius, Real z, const Vec3& direction) {
    return {radius * direction[0], radius * direction[1], z};
}

/// A circle around the z axis: the edge between a curved side and a flat side of a shape.
struct CylinderRim {
    Real radius, z;  // [m]
    // `outward`: direction of the outward normal of the curved side along the radius, 1 or -1. `along`: direction of
    // the outward normal of the flat side along z, 1 or -1.
    Real outward, along;
    bool can_touch_along(const Vec3& normal, const Vec3& direction) const {
        return outward * normal.head<2>().dot(direction.head<2>()) >= -rim_angle && along * normal[2] >= -rim_angle;
    }
};

/// Calls visit(k, direction, on) for each minimum of a distance along a rim, numbered by k. `direction`: unit vector
/// from the axis to the minimum. `on`: result of distance_at() there. Minima are searched between samples. If the
/// distance is constant along an arc, both ends of the arc are visited.
template <class Distance, class Visit>
void for_each_minimum(const CylinderRim& rim, Distance&& distance_at, Visit&& visit) {
    struct Sample {
        Vec3 direction;
        SurfacePoint on;
        Real slope;
    };
    const auto sample = [&](Real turn) {
        Sample at;
        at.direction = {std::cos(turn), std::sin(turn), 0};
        at.on = distance_at(rim_point(rim.radius, rim.z, at.direction));
        at.slope = at.on.normal.dot(Vec3(-at.direction[1], at.direction[0], 0));
        return at;
    };
    constexpr Real round = 2 * std::numbers::pi, between = round / samples_around;
    Index number = 0;
    std::optional<Real> first, last;  // angles at which the first and the last minimum were found [rad]
    // Finds, by bisection between two samples, the angle at which the derivative of the distance passes the value
    // `slope`, and visits it. `behind`: sample at `high`.
    const auto find = [&](Real low, Real high, Real slope, const Sample& behind) {
        Sample found = behind;
        while (high - low > turn_tolerance) {
            const Real middle = 0.5 * (low + high);
            const Sample there = sample(middle);
            if (there.slope < slope) {
                low = middle;
            } else {
                high = middle;
                found = there;
            }
        }
        const bool again = (last && high - *last < same_angle) || (first && high - *first > round - same_angle);
        last = high;
        if (!first) first = high;
        // If the derivative jumps past `slope`, the distance has a kink, which an edge of the other shape causes. The
        // contact points of this edge are found separately, so the kink is not visited.
        if (!again && number < numbers_per_rim && std::abs(found.slope) < rim_angle)
            visit(number++, found.direction, found.on);
    };
    Sample before = sample(0);
    for (int i = 1; i <= samples_around; ++i) {
        const Sample after = sample(i * between);
        const bool falls = before.slope<-level_slope, rises = after.slope> level_slope;
        const Real low = (i - 1) * between, high = i * between;
        // If the derivative is zero at a sample, the sample lies on an arc of constant distance or, by chance, at a
        // minimum. The derivative at a point a little beyond the sample decides between the two.
        if (falls && after.slope >= -level_slope) {
            const Sample beyond = rises ? after : sample(high + same_angle);
            if (beyond.slope > level_slope)
                find(low, rises ? high : high + same_angle, 0, beyond);
            else
                find(low, high, -level_slope, after);
        } else if (!falls && before.slope <= level_slope && rises) {
            const bool stretch = sample(low - same_angle).slope >= -level_slope;
            find(stretch ? low : low - same_angle, high, stretch ? level_slope : 0, after);
        }
        before = after;
    }
}

/// A flat side of a shape, in the frame of the shape.
struct FlatSide {
    Vec3 normal, at;
    enum class Region : std::uint8_t { all, rectangle, disc } region;
    Vec3 half;                  // half extents of a rectangle [m]
    Real inner = 0, outer = 0;  // inner and outer radius of a disc or ring [m]

    bool contains_projection(const Vec3& p) const {
        switch (region) {
            case Region::all:
                return true;
            case Region::rectangle:
                for (int i = 0; i < 3; ++i)
                    if (normal[i] == 0 && std::abs(p[i]) > (1 + over_fraction) * half[i]) return false;
                return true;
            case Region::disc:
                break;
        }
        const Real r = p.head<2>().norm();
        return r >= (1 - over_fraction) * inner && r <= (1 + over_fraction) * outer;
    }
};

/// Finds the contact points of the cylinder on one part of another shape.
class ShapeTouches {
public:
    ShapeTouches(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part, const RigidMotion& pose,
                 Real near, CylinderTouches& found)
        : own_(cylinder), other_(other), part_(part), pose_(pose), near_(near), found_(found) {}

    void run() {
        switch (other_.shape) {
            case ColliderShape::plane:
                touch_side(0, {Vec3::UnitZ(), Vec3::Zero(), FlatSide::Region::all, {}});
                return;
            case ColliderShape::sphere:
                touch_ball(own_, pose_.position, other_.size[0], near_, found_);
                return;
            case ColliderShape::capsule: {
                const Vec3 half = other_.size[1] * pose_.rotation.col(2);
                touch_capsule(own_, pose_.position - half, pose_.position + half, other_.size[0], near_, found_);
                return;
            }
            case ColliderShape::box:
                touch_rims();
                for (Index side = 0; side < 6; ++side) touch_side(side, side_of_box(side));
                touch_corners();
                touch_edges();
                return;
            case ColliderShape::cylinder:
                touch_rims();
                for (Index rim = 0; rim < 2; ++rim) touch_rim_of_other(rim, rim_of(other_, rim));
                for (Index side = 0; side < 2; ++side) touch_side(side, end_of(other_, side));
                for (Index end = 0; end < 2; ++end) touch_end(2 + end, end);
                touch_round_sides(other_.size[0], -other_.size[1], other_.size[1]);
                return;
            case ColliderShape::bucket:
                touch_bucket();
                return;
            case ColliderShape::mesh:
                break;
        }
    }

private:
    static CylinderRim rim_of(const ColliderGeometry& cylinder, Index end) {
        const Real up = end == 0 ? 1 : -1;
        return {cylinder.size[0], up * cylinder.size[1], 1, up};
    }
    static FlatSide end_of(const ColliderGeometry& cylinder, Index end) {
        const Vec3 normal(0, 0, end == 0 ? 1 : -1);
        return {normal, cylinder.size[1] * normal, FlatSide::Region::disc, {}, 0, cylinder.size[0]};
    }
    FlatSide side_of_box(Index side) const {
        Vec3 normal = Vec3::Zero();
        normal[side / 2] = side % 2 == 0 ? 1 : -1;
        return {normal, normal.cwiseProduct(other_.size), FlatSide::Region::rectangle, other_.size};
    }

    Vec3 to_other(const Vec3& p) const { return to_local(pose_, p); }
    Vec3 from_other(const Vec3& p) const { return to_world(pose_, p); }
    SurfacePoint other_at(const Vec3& p) const {
        SurfacePoint on = local_distance(other_, to_other(p), part_);
        on.normal = pose_.rotation * on.normal;
        on.point = from_other(on.point);
        return on;
    }
    /// True if a point p, whose projection lies on `side`, is in front of this side, or behind it and nearer to it than
    /// to the other sides. `height`: height of p above the side [m].
    static bool is_before(const FlatSide& side, Real height, const ColliderGeometry& geometry, Index part,
                          const Vec3& p) {
        return height >= 0 || local_distance(geometry, p, part).normal.dot(side.normal) > 1 - over_fraction;
    }
    void add(Index number, Real distance, const Vec3& normal, const Vec3& on_other) {
        if (distance <= near_) found_.add({number, distance, normal, on_other});
    }

    /// Adds the points where the rims of the cylinder are nearest to the other shape.
    void touch_rims() {
        for (Index end = 0; end < 2; ++end) {
            const CylinderRim rim = rim_of(own_, end);
            for_each_minimum(
                rim, [&](const Vec3& p) { return other_at(p); },
                [&](Index k, const Vec3& direction, const SurfacePoint& on) {
                    if (rim.can_touch_along(-on.normal, direction))
                        add(numbers_per_rim * end + k, on.distance, on.normal, on.point);
                });
        }
    }

    /// Adds the points where a rim of the other shape is nearest to the cylinder.
    void touch_rim_of_other(Index rim_number, const CylinderRim& rim) {
        for_each_minimum(
            rim,
            [&](const Vec3& p) {
                SurfacePoint on = local_distance(own_, from_other(p), 0);
                on.normal = pose_.rotation.transpose() * on.normal;
                return on;
            },
            [&](Index k, const Vec3& direction, const SurfacePoint& on) {
                if (!rim.can_touch_along(-on.normal, direction)) return;
                add(first_on_other_rims + numbers_per_rim * rim_number + k, on.distance, -(pose_.rotation * on.normal),
                    from_other(rim_point(rim.radius, rim.z, direction)));
            });
    }

    /// Adds the rim points (RimPoints) of the cylinder that are above a flat side of the other shape. If the side is a
    /// disc, it may lie below only a part of the rim. The points of the nearer rim whose projections on the plane of
    /// the side lie on the border of the disc are then added, too.
    void touch_side(Index number, const FlatSide& side) {
        const Vec3 normal = pose_.rotation * side.normal;
        const Vec3 at = from_other(side.at);
        const bool stands = normal.head<2>().norm() <= lying_sine;
        const auto add_if_above = [&](Index k, const Vec3& p) {
            const Real height = normal.dot(p - at);
            const Vec3 foot = p - height * normal;
            if (side.contains_projection(to_other(foot)) && is_before(side, height, other_, part_, to_other(p)))
                add(first_on_sides + numbers_per_side * number + k, height, normal, foot);
        };
        // If the ends of the cylinder are tilted against the side by more than 30 degrees (lying_sine), touch_rims()
        // already finds the only possible contact point of each rim, the one that reaches furthest.
        const bool all = side.region == FlatSide::Region::all;
        if (!all && !stands) return;
        for (const RimPoints::Point& p : RimPoints(own_, normal)) {
            const Index end = p.number / RimPoints::max_per_rim, k = p.number % RimPoints::max_per_rim;
            if (all)
                add(p.number, normal.dot(p.at - at), normal, p.at - normal.dot(p.at - at) * normal);
            else if ((end == 0) == (normal[2] < 0))
                add_if_above(k, p.at);
        }
        if (side.region != FlatSide::Region::disc) return;
        const CylinderRim rim = rim_of(own_, normal[2] < 0 ? 0 : 1);
        Index k = RimPoints::max_per_rim;
        for_each_passing(
            rim, [&](const Vec3& p) { return to_other(p).head<2>().norm() - side.outer; },
            [&](const Vec3& p) {
                if (k < numbers_per_side) add_if_above(k++, p);
            });
    }

    /// Called if the other shape is a cylinder, too: adds those rim points (RimPoints) of the other cylinder that are
    /// above an end of this cylinder.
    void touch_end(Index number, Index end) {
        const FlatSide side = end_of(own_, end);
        // Normal of the end in the frame of the other cylinder.
        const Vec3 normal = pose_.rotation.transpose() * side.normal;
        if (normal.head<2>().norm() > lying_sine) return;
        const auto add_if_above = [&](Index k, const Vec3& p) {
            const Vec3 here = from_other(p);
            const Real height = side.normal.dot(here - side.at);
            if (side.contains_projection(here) && is_before(side, height, own_, 0, here))
                add(first_on_sides + numbers_per_side * number + k, height, -side.normal, here);
        };
        for (const RimPoints::Point& p : RimPoints(other_, normal))
            if ((p.number / RimPoints::max_per_rim == 0) == (normal[2] < 0))
                add_if_above(p.number % RimPoints::max_per_rim, p.at);
    }

    template <class Value, class Visit>
    void for_each_passing(const CylinderRim& rim, Value&& value_at, Visit&& visit) const {
        const auto at = [&](Real turn) { return rim_point(rim.radius, rim.z, {std::cos(turn), std::sin(turn), 0}); };
        constexpr Real between = 2 * std::numbers::pi / samples_around;
        Real before = value_at(at(0));
        for (int i = 1; i <= samples_around; ++i) {
            const Real after = value_at(at(i * between));
            if ((before < 0) != (after < 0)) {
                Real low = (i - 1) * between, high = i * between;
                while (high - low > turn_tolerance) {
                    const Real middle = 0.5 * (low + high);
                    ((value_at(at(middle)) < 0) == (before < 0) ? low : high) = middle;
                }
                visit(at(0.5 * (low + high)));
            }
            before = after;
        }
    }

    void touch_corners() {
        for (Index k = 0; k < 8; ++k) {
            const Vec3 sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
            const Vec3 at = from_other(sign.cwiseProduct(other_.size));
            const SurfacePoint on = local_distance(own_, at, 0);
            if (!(on.distance <= near_)) continue;
            const Vec3 normal = pose_.rotation.transpose() * -on.normal;
            const bool faces = (normal.cwiseProduct(sign).array() >= -over_fraction).all();
            if (faces || nearest_region(on.normal) == CylinderRegion::end)
                add(first_at_corners + k, on.distance, -on.normal, at);
        }
    }

    void touch_edges() {
        Index edge = 0;
        for (int along = 0; along < 3; ++along)
            for (int k = 0; k < 4; ++k, ++edge) {
                Vec3 out = Vec3::Zero();
                out[(along + 1) % 3] = k & 1 ? 1 : -1;
                out[(along + 2) % 3] = k & 2 ? 1 : -1;
                const Vec3 middle = out.cwiseProduct(other_.size), half = other_.size[along] * Vec3::Unit(along);
                const Vec3 a = from_other(middle - half), b = from_other(middle + half);
                if (!(edge_distance(own_, 0, a, b) <= near_)) continue;
                const EdgeContact contact = edge_contact(own_, 0, a, b);
                for (std::size_t i = 0; i < contact.count; ++i) {
                    const EdgePoint& touch = contact.point[i];
                    const Vec3 normal = pose_.rotation.transpose() * -touch.on.normal;
                    if ((normal.cwiseProduct(out).array() >= -rim_angle).all())
                        add(first_on_edges + 8 * edge + touch.number, touch.on.distance, -touch.on.normal,
                            a + touch.s * (b - a));
                }
            }
    }

    /// Adds the contact point between the curved sides of the cylinder and the other shape, if the nearest points of
    /// their axes lie between the ends of the axes. For parallel axes, the rims make the contacts. `radius`: radius of
    /// the other curved side [m]. `low`, `high`: z coordinates of the ends of the other axis [m].
    void touch_round_sides(Real radius, Real low, Real high) {
        const Vec3 half = own_.size[1] * Vec3::UnitZ();
        const SegmentSegment nearest =
            closest_points_of_segments(-half, half, from_other({0, 0, low}), from_other({0, 0, high}));
        const Real length = std::sqrt(nearest.distance_squared);
        if (!nearest.interior || !(length > 0)) return;
        const Vec3 normal = (nearest.on_first - nearest.on_second) / length;
        // Inside the bucket the cylinder cannot touch the outer side. `length` is then below `radius`.
        if (other_.shape == ColliderShape::bucket && length < radius) return;
        add(first_between_round_sides, length - own_.size[0] - radius, normal, nearest.on_second + radius * normal);
    }

    void touch_bucket() {
        const Real inner = other_.size[0], height = other_.size[1], wall = other_.size[2], outer = inner + wall;
        touch_rims();
        if (part_ == 0) {
            touch_side(0, {Vec3::UnitZ(), Vec3::Zero(), FlatSide::Region::disc, {}, 0, inner});
            touch_side(1, {-Vec3::UnitZ(), {0, 0, -wall}, FlatSide::Region::disc, {}, 0, outer});
            return;
        }
        touch_rim_of_other(0, {inner, height, -1, 1});
        touch_rim_of_other(1, {outer, height, 1, 1});
        touch_rim_of_other(2, {outer, -wall, 1, -1});
        touch_side(0, {Vec3::UnitZ(), {0, 0, height}, FlatSide::Region::disc, {}, inner, outer});
        touch_round_sides(outer, -wall, height);
    }

    const ColliderGeometry &own_, &other_;
    const Index part_;
    const RigidMotion& pose_;
    const Real near_;
    CylinderTouches& found_;
};

}  // namespace

RimPoints::RimPoints(const ColliderGeometry& cylinder, const Vec3& normal) {
    const Real tilt = normal.head<2>().norm();
    const Vec3 deepest = tilt > 0 ? Vec3(-normal[0] / tilt, -normal[1] / tilt, 0) : Vec3(Vec3::UnitX());
    for (Index end = 0; end < 2; ++end) {
        const auto put = [&](Index k, const Vec3& direction) {
            point[count++] = {max_per_rim * end + k,
                              rim_point(cylinder.size[0], end == 0 ? cylinder.size[1] : -cylinder.size[1], direction)};
        };
        put(0, deepest);
        if (tilt > lying_sine) continue;
        const bool stands = tilt <= standing_tilt;
        const Vec3 first = stands ? Vec3(Vec3::UnitX()) : deepest, second(-first[1], first[0], 0);
        if (stands) put(1, first);
        put(2, second);
        put(3, -first);
        put(4, -second);
        for (Index k = 0; stands && k < 4; ++k)
            put(5 + k, std::sqrt(Real(0.5)) * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, 0));
    }
}

CylinderRegion nearest_region(const Vec3& gradient) {
    if (gradient.head<2>().norm() <= gradient_rounding) return CylinderRegion::end;
    return std::abs(gradient[2]) <= gradient_rounding ? CylinderRegion::side : CylinderRegion::rim;
}

void touch_ball(const ColliderGeometry& cylinder, const Vec3& middle, Real radius, Real near, CylinderTouches& found) {
    const SurfacePoint on = local_distance(cylinder, middle, 0);
    if (on.distance - radius <= near)
        found.add({0, on.distance - radius, -on.normal, middle - radius * on.normal, {1, 0}});
}

void touch_capsule(const ColliderGeometry& cylinder, const Vec3& a, const Vec3& b, Real radius, Real near,
                   CylinderTouches& found) {
    const auto add = [&](Index number, Real s, const SurfacePoint& on) {
        if (on.distance - radius <= near)
            found.add({number, on.distance - radius, -on.normal, a + s * (b - a) - radius * on.normal, {1 - s, s}});
    };
    add(0, 0, local_distance(cylinder, a, 0));
    add(1, 1, local_distance(cylinder, b, 0));
    const EdgeContact contact = edge_contact(cylinder, 0, a, b);
    for (std::size_t i = 0; i < contact.count; ++i)
        add(2 + contact.point[i].number, contact.point[i].s, contact.point[i].on);
}

void touch_shape(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part, const RigidMotion& pose,
                 Real near, CylinderTouches& found) {
    ShapeTouches(cylinder, other, part, pose, near, found).run();
}

}  // namespace skerry
