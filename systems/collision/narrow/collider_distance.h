// Signed distance to the analytic collider shapes.
#pragma once

#include "components/bvh_table.h"
#include "components/collider_table.h"

namespace skerry {

struct SurfacePoint {
    Real distance;  // m, > 0 outside
    Vec3 normal;    // unit, world frame, gradient of the distance
    Vec3 point;     // m, world frame, nearest point of the surface
};

/// Signed distance of a world point to a plane, sphere, box, capsule, cylinder or bucket. Exact outside and inside (a
/// box or cylinder pushes out through the nearest face). On a medial axis, where the nearest point is not unique, one
/// of them is chosen by a fixed rule.
SurfacePoint distance_to_collider(const ColliderGeometry& geometry, const RigidMotion& motion, const Vec3& world_point);

/// A bucket has two parts, floor and wall, so that a point in its corner touches both; every other shape is one part.
Index collider_part_count(ColliderShape shape);

/// Signed distance to one part. The distance to the collider outside of it is the least over its parts.
SurfacePoint distance_to_collider_part(const ColliderGeometry& geometry, const RigidMotion& motion, Index part,
                                       const Vec3& world_point);

/// The same in the frame of the collider. Of a part, or of all of it.
SurfacePoint local_distance(const ColliderGeometry& geometry, const Vec3& local_point, Index part = no_index);

/// World box around a collider of finite size; without bounds for a plane.
Aabb collider_box(const ColliderGeometry& geometry, const RigidMotion& motion);

/// No point of a collider of finite size is further from its origin, m; 0 for a plane.
Real collider_radius(const ColliderGeometry& geometry);

}  // namespace skerry
