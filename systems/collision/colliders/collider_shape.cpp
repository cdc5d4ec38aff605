#include "systems/collision/colliders/collider_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

// Number of test points on a rim: point 0 is the rim point furthest behind the plane of the face under test, points 1
// to 4 are fixed and 90 degrees apart.
constexpr Index points_of_rim = 5;

struct Rim {
    Real radius;  // [m]
    Real z;       // [m]
};

/// Returns one of the two outer rims of a cylinder or bucket. The inner rim of a bucket is left out: the solid
/// surrounds it, so the interior of a face cannot touch it, only an edge can.
Rim rim_of(const ColliderGeometry& geometry, Index rim) {
    const Vec3& size = geometry.size;
    if (geometry.shape == ColliderShape::bucket) return {size[0] + size[2], rim == 0 ? size[1] : -size[2]};
    return {size[0], rim == 0 ? size[1] : -size[1]};
}

Vec3 rim_direction(Index point, const Vec3& normal) {
    if (point > 0) return {point == 1 ? 1.0 : point == 3 ? -1.0 : 0.0, point == 2 ? 1.0 : point == 4 ? -1.0 : 0.0, 0};
    const Vec3 flat(-normal[0], -normal[1], 0);
    const Real length = flat.norm();
    return length > 0 ? Vec3(flat / length) : Vec3(Vec3::UnitX());
}

/// Distance that a point can move without leaving the flat region (flat_region) at one side of the shape; negative
/// outside of the region [m]. `above`: height of the point above the side. `beside`: distance, parallel to the side, of
/// the point from the border of the side. `thickness`: distance between the side and the opposite side.
///
/// Three kinds of planes bound the region; the least distance from them is returned:
/// - planes through the border, perpendicular to the side: distance `beside`
/// - planes through the border at 45 degrees, below which another side is nearer: (beside + above) / sqrt(2)
/// - the plane halfway to the opposite side: above + thickness / 2
Real within_side(Real beside, Real above, Real thickness) {
    return std::min({beside, (beside + above) * std::sqrt(Real(0.5)), above + thickness / 2});
}

Index flat_region_count(ColliderShape shape) {
    switch (shape) {
        case ColliderShape::plane:
            return 1;
        case ColliderShape::box:
            return 6;
        case ColliderShape::cylinder:
        case ColliderShape::bucket:
            return 2;
        case ColliderShape::sphere:
        case ColliderShape::capsule:
        case ColliderShape::mesh:
            break;
    }
    return 0;
}

/// Returns a convex shape that contains the collider, centred at hull_centre(): for a bucket the cylinder around it,
/// else the collider itself.
ColliderGeometry hull_of(const ColliderGeometry& geometry) {
    if (geometry.shape != ColliderShape::bucket) return geometry;
    const Vec3& size = geometry.size;
    return {ColliderShape::cylinder, {size[0] + size[2], (size[1] + size[2]) / 2, 0}};
}

Vec3 hull_centre(const ColliderGeometry& geometry) {
    if (geometry.shape != ColliderShape::bucket) return Vec3::Zero();
    return {0, 0, (geometry.size[1] - geometry.size[2]) / 2};
}

}  // namespace

Index collider_point_count(ColliderShape shape) {
    switch (shape) {
        case ColliderShape::sphere:
            return 1;
        case ColliderShape::capsule:
            return 2;
        case ColliderShape::box:
            return 8;
        case ColliderShape::cylinder:
        case ColliderShape::bucket:
            return 2 * points_of_rim;
        case ColliderShape::plane:
        case ColliderShape::mesh:
            break;
    }
    return 0;
}

ColliderPoint collider_point(const ColliderGeometry& geometry, Index k, const Vec3& normal) {
    const Vec3& size = geometry.size;
    if (geometry.shape == ColliderShape::sphere) return {Vec3::Zero(), size[0]};
    if (geometry.shape == ColliderShape::capsule) return {Vec3(0, 0, k == 0 ? size[1] : -size[1]), size[0]};
    if (geometry.shape == ColliderShape::box)
        return {Vec3(k & 1 ? size[0] : -size[0], k & 2 ? size[1] : -size[1], k & 4 ? size[2] : -size[2]), 0};
    const Rim rim = rim_of(geometry, k / points_of_rim);
    return {rim.radius * rim_direction(k % points_of_rim, normal) + Vec3(0, 0, rim.z), 0};
}

bool is_moving_rim_point(ColliderShape shape, Index k) {
    return (shape == ColliderShape::cylinder || shape == ColliderShape::bucket) && k % points_of_rim == 0;
}

Real flat_reach(const ColliderGeometry& geometry, Index region, const Vec3& p) {
    const Vec3& size = geometry.size;
    switch (geometry.shape) {
        case ColliderShape::plane:
            return infinity;
        case ColliderShape::box: {
            const int axis = static_cast<int>(region) / 2;
            const Real above = (region % 2 == 0 ? p[axis] : -p[axis]) - size[axis];
            Real least = infinity;
            for (int i = 0; i < 3; ++i)
                if (i != axis) least = std::min(least, within_side(size[i] - std::abs(p[i]), above, 2 * size[axis]));
            return least;
        }
        case ColliderShape::cylinder: {
            const Real above = (region == 0 ? p[2] : -p[2]) - size[1];
            return within_side(size[0] - std::sqrt(p[0] * p[0] + p[1] * p[1]), above, 2 * size[1]);
        }
        case ColliderShape::bucket: {
            const Real r = std::sqrt(p[0] * p[0] + p[1] * p[1]), half = size[2] / 2;
            if (region == 1) return within_side(size[0] + size[2] - r, -size[2] - p[2], size[2]);
            const Real below_rim = size[1] - p[2];
            return std::min(within_side(below_rim, size[0] - r, size[2]), p[2] + half);
        }
        case ColliderShape::sphere:
        case ColliderShape::capsule:
        case ColliderShape::mesh:
            break;
    }
    return -infinity;
}

Index flat_region(const ColliderGeometry& geometry, const Vec3& point) {
    Index best = no_index;
    Real furthest = -infinity;
    for (Index region = 0; region < flat_region_count(geometry.shape); ++region) {
        const Real reach = flat_reach(geometry, region, point);
        if (!(reach > furthest)) continue;
        furthest = reach;
        best = region;
    }
    return best;
}

Real flat_reach(const ColliderGeometry& geometry, std::span<const Vec3> points) {
    Real best = -infinity;
    for (Index region = 0; region < flat_region_count(geometry.shape); ++region) {
        Real least = infinity;
        for (const Vec3& p : points) least = std::min(least, flat_reach(geometry, region, p));
        best = std::max(best, least);
    }
    return best;
}

HullTangent hull_tangent(const ColliderGeometry& geometry, const Vec3& at) {
    const SurfacePoint found = local_distance(hull_of(geometry), at - hull_centre(geometry));
    return {at, found.normal, found.distance};
}

Real hull_distance(const ColliderGeometry& geometry, std::span<const Vec3> points) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : points) middle += p / static_cast<Real>(points.size());
    const HullTangent tangent = hull_tangent(geometry, middle);
    Real least = infinity;
    for (const Vec3& p : points) least = std::min(least, tangent.bound(p));
    return least;
}

FaceContact face_contact(const ColliderGeometry& geometry, Index k, const LocalFace& face) {
    const Vec3 area = (face[1] - face[0]).cross(face[2] - face[0]);
    const Real length = area.norm();
    FaceContact contact;
    contact.normal = length > 0 ? Vec3(area / length) : Vec3(Vec3::Zero());
    contact.point = collider_point(geometry, k, contact.normal);
    contact.closest = closest_point_on_triangle(contact.point.at, face[0], face[1], face[2]);
    const Real height = contact.normal.dot(contact.point.at - face[0]);
    contact.above = length > 0 && contact.closest.region == TriangleRegion::face;
    contact.distance = height - contact.point.radius;
    // Point 0 of a rim moves around the rim while the face rotates. A bound for this point must therefore hold for the
    // complete collider.
    contact.nearest = is_moving_rim_point(geometry.shape, k)
                          ? hull_distance(geometry, face)
                          : std::sqrt(contact.closest.distance_squared) - contact.point.radius;
    return contact;
}

}  // namespace skerry
