// Signed distance to the analytic collider shapes.
#pragma once

#include "components/bvh_table.h"
#include "components/collider_table.h"

namespace skerry {

struct SurfacePoint {
    Real distance;  // signed, positive outside [m]
    Vec3 normal;    // unit gradient of the distance, in the frame of the query
    Vec3 point;     // nearest point of the surface, in the frame of the query [m]
};

/// Signed distance of a world point to a plane, sphere, box, capsule, cylinder or bucket. Exact outside and inside (a
/// box or cylinder pushes out through the nearest face). On a medial axis, where the nearest point is not unique, one
/// of them is chosen by a fixed rule.
SurfacePoint distance_to_collider(const ColliderGeometry& geometry, const RigidMotion& motion, const Vec3& world_point);

/// Number of parts. A bucket has two, floor and wall, so that a point in its corner touches both; other shapes have
/// one.
Index collider_part_count(ColliderShape shape);

/// Signed distance to one part. Outside of the collider its distance is the least over its parts.
SurfacePoint distance_to_collider_part(const ColliderGeometry& geometry, const RigidMotion& motion, Index part,
                                       const Vec3& world_point);

/// Signed distance in the frame of the collider, to one part or to all of it (no_index).
SurfacePoint local_distance(const ColliderGeometry& geometry, const Vec3& local_point, Index part = no_index);

/// Extent of a shape from its origin along a unit direction in its frame [m]. For a part of a bucket it is that of the
/// part's convex hull; no_index stands for all parts.
Real extent_along(const ColliderGeometry& geometry, Index part, const Vec3& direction);

/// World box around a collider of finite size; unbounded for a plane or a mesh.
Aabb collider_box(const ColliderGeometry& geometry, const RigidMotion& motion);

/// Upper bound of the distance of a point of the collider from its origin [m]; 0 for a plane or a mesh.
Real collider_radius(const ColliderGeometry& geometry);

}  // namespace skerry
