#include "systems/collision/cylinders/cylinder_touches.h"

#include <algorithm>
#include <cmath>

#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/tree/box.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

Real ball_radius(const ColliderGeometry& cylinder) {
    return std::hypot(cylinder.size[0], cylinder.size[1]);
}

}  // namespace

Real distance_bound(const ColliderGeometry& cylinder, const LocalFace& face) {
    const PointTriangle nearest = closest_point_on_triangle(Vec3::Zero(), face[0], face[1], face[2]);
    const SurfacePoint on = local_distance(cylinder, nearest.nearest, 0);
    Real least = infinity;
    for (const Vec3& p : face) least = std::min(least, on.distance + on.normal.dot(p - nearest.nearest));
    return std::max(least, std::sqrt(nearest.distance_squared) - ball_radius(cylinder));
}

Real shape_distance_bound(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part,
                          const RigidMotion& pose, const CylinderTouches& touches) {
    const auto reach = [&](const Vec3& direction) { return extent_along(cylinder, 0, direction); };
    if (other.shape == ColliderShape::plane) {
        const Vec3 normal = pose.rotation.col(2);
        return -normal.dot(pose.position) - reach(normal);
    }
    // Centre of the cylinder in the frame of the other shape.
    const Vec3 middle = -(pose.rotation.transpose() * pose.position);
    Real bound = local_distance(other, middle, part).distance - ball_radius(cylinder);
    const auto test_along = [&](const Vec3& normal) {
        bound = std::max(bound, -normal.dot(pose.position) - reach(normal) -
                                    extent_along(other, part, pose.rotation.transpose() * normal));
    };
    for (const Vec3& axis :
         {Vec3(Vec3::UnitZ()), Vec3(pose.rotation.col(0)), Vec3(pose.rotation.col(1)), Vec3(pose.rotation.col(2))})
        test_along(axis.dot(pose.position) > 0 ? Vec3(-axis) : axis);
    if (other.shape == ColliderShape::cylinder) {  // each cylinder is contained in a capsule around its axis
        const Vec3 own = cylinder.size[1] * Vec3::UnitZ(), half = other.size[1] * pose.rotation.col(2);
        const Real apart =
            closest_points_of_segments(-own, own, pose.position - half, pose.position + half).distance_squared;
        bound = std::max(bound, std::sqrt(apart) - cylinder.size[0] - other.size[0]);
    }
    for (const CylinderTouch& touch : touches) test_along(touch.normal);
    return bound;
}

}  // namespace skerry
