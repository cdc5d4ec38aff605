// Signed distances from the analytic collider shapes.
#pragma once

#include "components/bvh_table.h"
#include "components/collider_table.h"

namespace skerry {

struct SurfacePoint {
    Real distance;  // signed distance of the queried point from the surface, positive outside [m]
    Vec3 normal;    // unit gradient of the distance, in the frame in which the queried point was given
    Vec3 point;     // nearest point of the surface, in the same frame as `normal` [m]
};

/// Signed distance of a world point from a plane, sphere, box, capsule, cylinder or bucket. The distance is exact
/// outside and inside the shape: inside, it is the distance from the nearest point of the surface, with negative sign.
/// Where the nearest point is not unique (medial axis), a fixed rule selects one.
SurfacePoint distance_to_collider(const ColliderGeometry& geometry, const RigidMotion& motion, const Vec3& world_point);

/// Number of parts of a collider. A bucket has two parts, floor and wall, so that a point in the corner between them
/// touches both. Other shapes have one part.
Index collider_part_count(ColliderShape shape);

/// Signed distance of a world point from one part of a collider. Outside of the collider, the distance from the
/// complete collider is the least distance from its parts.
SurfacePoint distance_to_collider_part(const ColliderGeometry& geometry, const RigidMotion& motion, Index part,
                                       const Vec3& world_point);

/// Signed distance of a point from one part of a collider, or from the complete collider if `part` is no_index. The
/// point is given in the frame of the collider.
SurfacePoint local_distance(const ColliderGeometry& geometry, const Vec3& local_point, Index part = no_index);

/// Support function of a shape: largest coordinate of its points along a unit direction, measured from the origin of
/// the shape [m]; infinity for a plane or a mesh. `part`: number of a part, or no_index for the complete shape.
Real extent_along(const ColliderGeometry& geometry, Index part, const Vec3& direction);

/// Axis-aligned box of a collider in the world; unbounded for a plane or a mesh.
Aabb collider_box(const ColliderGeometry& geometry, const RigidMotion& motion);

/// Upper bound of the distance between the collider's origin and any point of the collider [m]; 0 for a plane or a
/// mesh.
Real collider_radius(const ColliderGeometry& geometry);

}  // namespace skerry
