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

/// Extent of a shape along a unit direction in its frame [m]. For a part of a bucket it is that of the part's convex
/// hull.
Real reach_along(const ColliderGeometry& geometry, Index part, const Vec3& direction) {
    const Vec3& size = geometry.size;
    const Real out = direction.head<2>().norm(), up = direction[2];
    switch (geometry.shape) {
        case ColliderShape::sphere:
            return size[0];
        case ColliderShape::box:
            return direction.cwiseAbs().dot(size);
        case ColliderShape::capsule:
            return size[0] + std::abs(up) * size[1];
        case ColliderShape::cylinder:
            return out * size[0] + std::abs(up) * size[1];
        case ColliderShape::bucket:
            return out * (size[0] + size[2]) + (up > 0 ? (part == 0 ? 0 : up * size[1]) : -up * size[2]);
        case ColliderShape::plane:
        case ColliderShape::mesh:
            break;
    }
    return infinite;
}

}  // namespace

Real distance_bound(const ColliderGeometry& cylinder, const LocalFace& face) {
    const PointTriangle nearest = closest_point_on_triangle(Vec3::Zero(), face[0], face[1], face[2]);
    const SurfacePoint on = local_distance(cylinder, nearest.nearest, 0);
    Real least = infinite;
    for (const Vec3& p : face) least = std::min(least, on.distance + on.normal.dot(p - nearest.nearest));
    return std::max(least, std::sqrt(nearest.distance_squared) - ball_radius(cylinder));
}

Real shape_distance_bound(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part,
                          const RigidMotion& place, const CylinderTouches& touches) {
    const auto reach = [&](const Vec3& direction) { return reach_along(cylinder, 0, direction); };
    if (other.shape == ColliderShape::plane) {
        const Vec3 normal = place.rotation.col(2);
        return -normal.dot(place.position) - reach(normal);
    }
    const Vec3 middle = -(place.rotation.transpose() * place.position);  // of the cylinder, in the frame of the other
    Real bound = local_distance(other, middle, part).distance - ball_radius(cylinder);
    const auto look_along = [&](const Vec3& normal) {
        bound = std::max(bound, -normal.dot(place.position) - reach(normal) -
                                    reach_along(other, part, place.rotation.transpose() * normal));
    };
    for (const Vec3& axis :
         {Vec3(Vec3::UnitZ()), Vec3(place.rotation.col(0)), Vec3(place.rotation.col(1)), Vec3(place.rotation.col(2))})
        look_along(axis.dot(place.position) > 0 ? Vec3(-axis) : axis);
    if (other.shape == ColliderShape::cylinder) {  // each lies within the capsule around its axis
        const Vec3 own = cylinder.size[1] * Vec3::UnitZ(), half = other.size[1] * place.rotation.col(2);
        const Real apart =
            closest_points_of_segments(-own, own, place.position - half, place.position + half).distance_squared;
        bound = std::max(bound, std::sqrt(apart) - cylinder.size[0] - other.size[0]);
    }
    for (const CylinderTouch& touch : touches) look_along(touch.normal);
    return bound;
}

}  // namespace skerry
