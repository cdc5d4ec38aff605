#include "systems/collision/narrow/collider_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/check.h"
#include "systems/collision/narrow/rigid_frame.h"
#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

// A vector shorter than this [m] has no reliable direction because of rounding errors; the normal of a side, or an
// axis, is used instead.
constexpr Real min_length = 1e-14;

Vec3 direction_or(const Vec3& v, Real length, const Vec3& otherwise) {
    return length > min_length ? Vec3(v / length) : otherwise;
}

SurfacePoint distance_to_ball(const Vec3& p, const Vec3& centre, Real radius) {
    const Vec3 offset = p - centre;
    const Real length = offset.norm();
    const Vec3 normal = direction_or(offset, length, Vec3::UnitZ());
    return {length - radius, normal, centre + radius * normal};
}

SurfacePoint distance_to_box(const Vec3& p, const Vec3& half) {
    const Vec3 beyond = p.cwiseAbs() - half;
    // Axis of the nearest face if p is inside the box; if several faces are equally near, the lowest axis.
    int face = 0;
    for (int i = 1; i < 3; ++i)
        if (beyond[i] > beyond[face]) face = i;
    Vec3 face_normal = Vec3::Zero();
    face_normal[face] = p[face] < 0 ? -1 : 1;
    if (!(beyond[face] > 0)) return {beyond[face], face_normal, p - beyond[face] * face_normal};
    const Vec3 nearest = p.cwiseMin(half).cwiseMax(-half);
    const Vec3 offset = p - nearest;
    const Real length = offset.norm();
    return {length, direction_or(offset, length, face_normal), nearest};
}

/// A point in a half plane that is bounded by the axis of a body of revolution.
struct ProfilePoint {
    Real r;  // distance from the axis [m]
    Real z;  // height along the axis [m]
};

Real norm(const ProfilePoint& v) {
    return std::sqrt(v.r * v.r + v.z * v.z);
}

struct ProfileDistance {
    Real distance;
    ProfilePoint normal;
    ProfilePoint nearest;
};

/// Signed distance from the rectangle r0 <= r <= r1, z0 <= z <= z1, the profile of a solid of revolution. For a solid
/// without a hole, r0 is -infinity. If several sides are equally near, the upper or lower side (an end face) is
/// preferred.
ProfileDistance distance_to_rectangle(const ProfilePoint& p, Real r0, Real r1, Real z0, Real z1) {
    const bool top = p.z >= 0.5 * (z0 + z1);
    const bool outer = r0 == -infinity || p.r >= 0.5 * (r0 + r1);
    const Real beyond_z = top ? p.z - z1 : z0 - p.z;
    const Real beyond_r = outer ? p.r - r1 : r0 - p.r;
    const bool through_end = beyond_z >= beyond_r;
    const ProfilePoint side = through_end ? ProfilePoint{0, top ? 1.0 : -1.0} : ProfilePoint{outer ? 1.0 : -1.0, 0};
    if (!(beyond_z > 0) && !(beyond_r > 0)) {
        const Real depth = through_end ? beyond_z : beyond_r;
        return {depth, side, {p.r - depth * side.r, p.z - depth * side.z}};
    }
    const ProfilePoint nearest{std::clamp(p.r, r0, r1), std::clamp(p.z, z0, z1)};
    const ProfilePoint offset{p.r - nearest.r, p.z - nearest.z};
    const Real length = norm(offset);
    return {length, length > min_length ? ProfilePoint{offset.r / length, offset.z / length} : side, nearest};
}

/// Half plane that is bounded by the axis (z) of a body of revolution and contains the point p. By symmetry it also
/// contains the point of the body nearest to p.
struct AxialFrame {
    Vec3 radial;  // unit vector from the axis to p; +x if p is on the axis
    ProfilePoint p;

    explicit AxialFrame(const Vec3& point) {
        const Real r = std::sqrt(point[0] * point[0] + point[1] * point[1]);
        radial = direction_or(Vec3(point[0], point[1], 0), r, Vec3::UnitX());
        p = {r, point[2]};
    }
    Vec3 lift(const ProfilePoint& v) const { return v.r * radial + Vec3(0, 0, v.z); }
    SurfacePoint lift(const ProfileDistance& d) const { return {d.distance, lift(d.normal), lift(d.nearest)}; }
};

ProfileDistance distance_to_bucket_part(const Vec3& size, Index part, const ProfilePoint& p) {
    if (part == 0) return distance_to_rectangle(p, -infinity, size[0] + size[2], -size[2], 0);
    return distance_to_rectangle(p, size[0], size[0] + size[2], -size[2], size[1]);
}

/// Signed distance from the L-shaped profile of a bucket. Outside of the profile, this is the distance from the nearer
/// part; inside, it is the distance from the nearest side. If several sides are equally near, the first one in `sides`
/// is used.
ProfileDistance distance_to_bucket(const Vec3& size, const ProfilePoint& p) {
    const ProfileDistance floor = distance_to_bucket_part(size, 0, p), wall = distance_to_bucket_part(size, 1, p);
    if (floor.distance > 0 && wall.distance > 0) return floor.distance <= wall.distance ? floor : wall;

    const Real inner = size[0], height = size[1], outer = size[0] + size[2], bottom = -size[2];
    struct Side {
        ProfilePoint from, to, normal;
    };
    const std::array<Side, 5> sides{{{{0, 0}, {inner, 0}, {0, 1}},
                                     {{inner, 0}, {inner, height}, {-1, 0}},
                                     {{inner, height}, {outer, height}, {0, 1}},
                                     {{outer, bottom}, {outer, height}, {1, 0}},
                                     {{0, bottom}, {outer, bottom}, {0, -1}}}};
    ProfileDistance best{-infinity, {0, 1}, p};
    for (const Side& side : sides) {
        const ProfilePoint nearest{std::clamp(p.r, std::min(side.from.r, side.to.r), std::max(side.from.r, side.to.r)),
                                   std::clamp(p.z, std::min(side.from.z, side.to.z), std::max(side.from.z, side.to.z))};
        const ProfilePoint offset{nearest.r - p.r, nearest.z - p.z};
        const Real length = norm(offset);
        if (!(-length <= best.distance))  // negated, so that a NaN `length` is stored and returned
            best = {-length, length > min_length ? ProfilePoint{offset.r / length, offset.z / length} : side.normal,
                    nearest};
    }
    return best;
}

}  // namespace

SurfacePoint local_distance(const ColliderGeometry& geometry, const Vec3& p, Index part) {
    const Vec3& size = geometry.size;
    switch (geometry.shape) {
        case ColliderShape::plane:
            return {p[2], Vec3::UnitZ(), Vec3(p[0], p[1], 0)};
        case ColliderShape::sphere:
            return distance_to_ball(p, Vec3::Zero(), size[0]);
        case ColliderShape::box:
            return distance_to_box(p, size);
        case ColliderShape::capsule:
            return distance_to_ball(p, Vec3(0, 0, std::clamp(p[2], -size[1], size[1])), size[0]);
        case ColliderShape::cylinder: {
            const AxialFrame frame(p);
            return frame.lift(distance_to_rectangle(frame.p, -infinity, size[0], -size[1], size[1]));
        }
        case ColliderShape::bucket: {
            const AxialFrame frame(p);
            return frame.lift(part == no_index ? distance_to_bucket(size, frame.p)
                                               : distance_to_bucket_part(size, part, frame.p));
        }
        case ColliderShape::mesh:
            break;
    }
    check_failed("a mesh collider has no analytic distance", __FILE__, __LINE__);
}

SurfacePoint distance_to_collider(const ColliderGeometry& geometry, const RigidMotion& motion,
                                  const Vec3& world_point) {
    return distance_to_collider_part(geometry, motion, no_index, world_point);
}

Index collider_part_count(ColliderShape shape) {
    return shape == ColliderShape::bucket ? 2 : 1;
}

SurfacePoint distance_to_collider_part(const ColliderGeometry& geometry, const RigidMotion& motion, Index part,
                                       const Vec3& world_point) {
    const SurfacePoint found = local_distance(geometry, to_local(motion, world_point), part);
    return {found.distance, motion.rotation * found.normal, to_world(motion, found.point)};
}

Real extent_along(const ColliderGeometry& geometry, Index part, const Vec3& direction) {
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
    return infinity;
}

Aabb collider_box(const ColliderGeometry& geometry, const RigidMotion& motion) {
    Aabb box{motion.position, motion.position};
    for (int i = 0; i < 3; ++i) {
        const Vec3 axis = motion.rotation.row(i).transpose();
        box.lower[i] -= extent_along(geometry, no_index, -axis);
        box.upper[i] += extent_along(geometry, no_index, axis);
    }
    return box;
}

Real collider_radius(const ColliderGeometry& geometry) {
    const Vec3& size = geometry.size;
    switch (geometry.shape) {
        case ColliderShape::sphere:
            return size[0];
        case ColliderShape::box:
            return size.norm();
        case ColliderShape::capsule:
            return size[0] + size[1];
        case ColliderShape::cylinder:
            return std::hypot(size[0], size[1]);
        case ColliderShape::bucket:
            return std::hypot(size[0] + size[2], std::max(size[1], size[2]));
        case ColliderShape::plane:
        case ColliderShape::mesh:
            break;
    }
    return 0;
}

}  // namespace skerry
