#include "systems/collision/colliders/time_of_touch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/tree/box.h"
#include "systems/geometry/conservative_advancement.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

using Nodes = std::array<Vec3, 3>;

// Accuracy of the parameter (0 to 1 along an edge) at which the distance is least.
constexpr Real parameter_tolerance = 1e-12;

Touch of_surface(const SurfacePoint& on, Real distance, const std::array<Real, 3>& weight) {
    return {distance, weight, on.point, on.normal};
}

/// Nearest points of an edge and a convex collider part, found by bisection: the distance along the edge is convex, so
/// it is least where its derivative changes sign. Outside of the part the gradient of the distance is continuous, so
/// the normal at the found point is accurate.
Touch nearest_on_convex(const ColliderGeometry& geometry, Index part, const Nodes& end) {
    const Vec3 edge = end[1] - end[0];
    const auto at = [&](Real s) { return local_distance(geometry, end[0] + s * edge, part); };
    Real low = 0, high = 1;
    const SurfacePoint first = at(0);
    SurfacePoint last = at(1);
    if (!(first.normal.dot(edge) < 0)) return of_surface(first, first.distance, {1, 0, 0});
    if (!(last.normal.dot(edge) > 0)) return of_surface(last, last.distance, {0, 1, 0});
    while (high - low > parameter_tolerance) {
        const Real middle = 0.5 * (low + high);
        const SurfacePoint at_middle = at(middle);
        if (at_middle.normal.dot(edge) < 0) {
            low = middle;
        } else {
            high = middle;
            last = at_middle;
        }
    }
    return of_surface(last, last.distance, {1 - high, high, 0});
}

/// The wall of a bucket: a hollow cylinder between an inner and an outer radius.
class Wall {
public:
    Wall(const ColliderGeometry& geometry, const Nodes& end)
        : inner_(geometry.size[0]),
          outer_(geometry.size[0] + geometry.size[2]),
          bottom_(-geometry.size[2]),
          rim_(geometry.size[1]),
          start_(end[0]),
          edge_(end[1] - end[0]) {
        const Real across = edge_.head<2>().squaredNorm();
        nearest_to_axis_ =
            across > 0 ? std::clamp(-start_.head<2>().dot(edge_.head<2>()) / across, Real(0), Real(1)) : 0;
    }

    /// Lower bound of the distance between the wall and the stretch of the edge between the parameters `low` and `high`
    /// [m]. It combines the radial gap, from the least and greatest distance of the stretch from the axis, with the
    /// axial gap, from its least and greatest height.
    Real bound(Real low, Real high) const {
        const Real r_low = from_axis(low), r_high = from_axis(high), r_max = std::max(r_low, r_high),
                   r_min = from_axis(std::clamp(nearest_to_axis_, low, high)), z_low = height(low),
                   z_high = height(high);
        const Real beside = std::max({inner_ - r_max, r_min - outer_, Real(0)}),
                   above = std::max({std::min(z_low, z_high) - rim_, bottom_ - std::max(z_low, z_high), Real(0)});
        return std::sqrt(beside * beside + above * above);
    }

private:
    Real from_axis(Real s) const { return (start_ + s * edge_).head<2>().norm(); }
    Real height(Real s) const { return start_[2] + s * edge_[2]; }

    const Real inner_, outer_, bottom_, rim_;  // [m]
    const Vec3 start_, edge_;                  // [m]
    Real nearest_to_axis_;
};

/// Nearest points of an edge and the wall of a bucket. The distance may have several minima along the edge, so they are
/// found by branch and bound. All distances are reduced by `threshold` [m].
///
/// The returned distance is a lower bound of the least distance, and at least half of the distance at the returned
/// point. If the search reaches its limit of samples, it is at least a quarter of that distance, but not always a lower
/// bound.
Touch nearest_on_wall(const ColliderGeometry& geometry, Index part, const Nodes& end, Real threshold) {
    constexpr int max_samples = 1024;
    const Wall wall(geometry, end);
    const auto at = [&](Real s) {
        SurfacePoint on = local_distance(geometry, end[0] + s * (end[1] - end[0]), part);
        on.distance -= threshold;
        return on;
    };
    struct Interval {
        Real low, high;
    };
    std::array<Interval, 64> open;
    std::size_t count = 0;
    Real best = 0, value = at(0).distance, bound = value;
    const auto sample = [&](Real s) {
        const Real distance = at(s).distance;
        if (!(distance < value)) return;
        value = distance;
        best = s;
    };
    sample(1);
    open[count++] = {0, 1};
    for (int samples = 0; count > 0 && value > 0; ++samples) {
        const Interval interval = open[--count];
        const Real least = wall.bound(interval.low, interval.high) - threshold;
        if (least >= value / 2 || samples >= max_samples || count + 2 > open.size()) {
            bound = std::min(bound, std::max(least, value / 4));
            continue;
        }
        const Real middle = 0.5 * (interval.low + interval.high);
        sample(middle);
        open[count++] = {middle, interval.high};
        open[count++] = {interval.low, middle};
    }
    return of_surface(at(best), std::min(bound, value), {1 - best, best, 0});
}

Touch nearest_on_edge(const ColliderGeometry& geometry, Index part, const Nodes& end, Real threshold) {
    const bool is_wall = geometry.shape == ColliderShape::bucket && part == 1;
    if (is_wall) return nearest_on_wall(geometry, part, end, threshold);
    Touch nearest = nearest_on_convex(geometry, part, end);
    nearest.distance -= threshold;
    return nearest;
}

/// Nearest points of a face and the disc inside a rim. The rim point that reaches furthest towards the face is sought
/// for both sides of the face. If it is in front of this side and its projection lies inside the face, it is the
/// nearest point. Otherwise an edge of the face is nearest: `in_face` is false, and the returned distance is only a
/// lower bound.
Touch nearest_on_rim(const ColliderGeometry& geometry, Index k, const Nodes& corner) {
    const FaceContact front = face_contact(geometry, k, corner),
                      back = face_contact(geometry, k, {corner[0], corner[2], corner[1]});
    if (front.above && front.distance > 0) return {front.distance, front.closest.weight, front.point.at, -front.normal};
    const auto& behind = back.closest.weight;
    if (back.above && back.distance > 0)
        return {back.distance, {behind[0], behind[2], behind[1]}, back.point.at, -back.normal};
    const Vec3& furthest = front.point.at;
    const Vec3 centre(0, 0, furthest.z());
    const ColliderGeometry disc{ColliderShape::cylinder, {furthest.head<2>().norm(), 0, 0}};
    Touch nearest{infinity, {}, furthest, Vec3::Zero(), false};
    for (std::size_t i = 0; i < 3; ++i) {
        const Nodes end{corner[i] - centre, corner[(i + 1) % 3] - centre, Vec3::Zero()};
        nearest.distance = std::min(nearest.distance, nearest_on_convex(disc, 0, end).distance);
    }
    nearest.distance = std::max({nearest.distance, front.distance, back.distance});
    return nearest;
}

Touch nearest_on_face(const ColliderGeometry& geometry, Index k, const Nodes& corner) {
    if (is_moving_rim_point(geometry.shape, k)) return nearest_on_rim(geometry, k, corner);
    const ColliderPoint point = collider_point(geometry, k, Vec3::Zero());
    const PointTriangle closest = closest_point_on_triangle(point.at, corner[0], corner[1], corner[2]);
    const Vec3 offset = closest.nearest - point.at;
    const Real length = offset.norm();
    const Vec3 normal = length > 0 ? Vec3(offset / length) : Vec3(Vec3::Zero());
    return {length - point.radius, closest.weight, point.at + point.radius * normal, normal};
}

bool touches_within(const TouchingFeature& feature, const Touch& touch, const Nodes& nodes) {
    return feature.kind == TouchingFeature::Kind::face &&
           touch.normal.dot((nodes[1] - nodes[0]).cross(nodes[2] - nodes[0])) > 0;
}

/// Motion of a feature of a body relative to a collider. Times are fractions of the step.
class RelativeMotion {
public:
    RelativeMotion(const RigidMotion& motion, Real h, const TouchingFeature& feature)
        : motion_(motion), feature_(feature), shift_(h * motion.velocity), turn_(h * motion.angular_velocity) {}

    Nodes at(Real time) const {
        const Mat3 back = rotation(time).transpose();
        Nodes local;
        for (std::size_t i = 0; i < feature_.nodes(); ++i) local[i] = back * arm(i, time);
        return local;
    }

    /// Upper bound of the speeds of all nodes of the feature relative to the collider during the whole step [m per
    /// step]. It is the speed at the start plus |turn| |drift| (docs/methods/collision.md 7.5).
    ///
    /// drift: displacement of the node relative to the collider; turn: rotation vector of the collider. A node has the
    /// velocity drift - turn x arm, and the arm from the collider's origin to the node changes by at most |drift|.
    Real greatest_speed() const {
        Real greatest = 0;
        for (std::size_t i = 0; i < feature_.nodes(); ++i)
            greatest = std::max(greatest, velocity(i, 0).norm() + turn_.norm() * drift(i).norm());
        return greatest;
    }

    /// Duration d after `time` in which no node can pass the tangent plane at the nearest point of the collider, as a
    /// fraction of the step. With the speed v of a node towards the plane at `time`, and an upper bound a of its
    /// acceleration, the node approaches by at most d v + d^2 a / 2 <= d (v + a (1 - time) / 2).
    Real time_before_plane(const Touch& touch, const Nodes& nodes, Real time) const {
        const Vec3 normal = rotation(time) * touch.normal;
        Real least = infinity;
        for (std::size_t i = 0; i < feature_.nodes(); ++i) {
            const Real above = touch.normal.dot(nodes[i] - touch.point) - feature_.threshold.distance,
                       approach = greatest_turn(i) * (1 - time) / 2 - normal.dot(velocity(i, time));
            if (approach > 0) least = std::min(least, above / approach);
        }
        return least;
    }

private:
    Mat3 rotation(Real time) const {
        return turn_.isZero(0) ? motion_.rotation : Mat3(rotation_matrix(time * turn_) * motion_.rotation);
    }
    Vec3 arm(std::size_t i, Real time) const {
        return feature_.position[i] + time * feature_.displacement[i] - (motion_.position + time * shift_);
    }
    Vec3 drift(std::size_t i) const { return feature_.displacement[i] - shift_; }
    /// Velocity of node i relative to the rotating frame of the collider, expressed in world axes [m per step].
    Vec3 velocity(std::size_t i, Real time) const { return drift(i) - turn_.cross(arm(i, time)); }
    /// Upper bound of the acceleration of node i in the rotating frame of the collider [m per step^2]: Coriolis term 2
    /// |turn| |drift| plus centrifugal term |turn|^2 |arm|.
    Real greatest_turn(std::size_t i) const {
        const Real turning = turn_.norm(), drifting = drift(i).norm();
        return turning * (2 * drifting + turning * (arm(i, 0).norm() + drifting));
    }

    const RigidMotion& motion_;
    const TouchingFeature& feature_;
    const Vec3 shift_;  // translation of the collider in the step [m]
    const Vec3 turn_;   // rotation vector of the collider in the step [rad]
};

/// True if the tangent plane at the nearest point of the collider separates the feature from the tested part of the
/// collider (for a face: from the tested collider point and its ball). The feature then cannot touch before one of its
/// nodes passes this plane. False in two cases:
/// - the wall of a bucket, which is not convex;
/// - a face with one of its edges nearest, because Touch then has no normal.
bool lies_behind(const ColliderGeometry& geometry, const TouchingFeature& feature, const Touch& touch) {
    if (feature.kind == TouchingFeature::Kind::face) return touch.in_face;
    return geometry.shape != ColliderShape::bucket || feature.part_or_point == 0;
}

}  // namespace

bool end_position_suffices(const ColliderGeometry& geometry, const TouchingFeature& feature) {
    return geometry.shape == ColliderShape::plane && !(feature.threshold.distance > 0);
}

Touch nearest_touch(const ColliderGeometry& geometry, const TouchingFeature& feature,
                    const std::array<Vec3, 3>& nodes) {
    switch (feature.kind) {
        case TouchingFeature::Kind::node: {
            const SurfacePoint on = local_distance(geometry, nodes[0], feature.part_or_point);
            return of_surface(on, on.distance - feature.threshold.distance, {1, 0, 0});
        }
        case TouchingFeature::Kind::edge:
            return nearest_on_edge(geometry, feature.part_or_point, nodes, feature.threshold.distance);
        case TouchingFeature::Kind::face:
            break;
    }
    return nearest_on_face(geometry, feature.part_or_point, nodes);
}

Real greatest_approach(const RigidMotion& motion, Real h, const TouchingFeature& feature) {
    return RelativeMotion(motion, h, feature).greatest_speed();
}

std::optional<Touch> first_touch(const ColliderGeometry& geometry, const RigidMotion& motion, Real h,
                                 const TouchingFeature& feature, Real* time_of_touch) {
    const RelativeMotion moving(motion, h, feature);
    const Real speed = moving.greatest_speed();
    Nodes nodes = moving.at(0);
    Touch touch = nearest_touch(geometry, feature, nodes);
    const Real start = touch.distance;
    if (!(start > 0)) return std::nullopt;
    if (end_position_suffices(geometry, feature)) {
        touch = nearest_touch(geometry, feature, moving.at(1));
        return touch.distance < 0 ? std::optional(touch) : std::nullopt;
    }
    const std::optional<Real> time = advance_conservatively(
        start, std::min(contact_slack * start, feature.threshold.near),
        [&](Real gap, Real now) {
            const Real free = gap / speed;
            return lies_behind(geometry, feature, touch) ? std::max(free, moving.time_before_plane(touch, nodes, now))
                                                         : free;
        },
        [&](Real now) {
            nodes = moving.at(now);
            touch = nearest_touch(geometry, feature, nodes);
            return touch.distance;
        });
    if (!time || !touch.in_face) return std::nullopt;
    touch.within = touches_within(feature, touch, nodes);
    if (time_of_touch != nullptr) *time_of_touch = *time;
    return touch;
}

}  // namespace skerry
