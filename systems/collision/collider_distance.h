// Signed distance to the analytic collider shapes.
#pragma once

#include "components/collider_table.h"

namespace skerry {

struct SurfacePoint {
    Real distance;  // m, > 0 outside
    Vec3 normal;    // unit, world frame, gradient of the distance
    Vec3 point;     // m, world frame, nearest point of the surface
};

/// Signed distance of a world point to a plane, sphere, box, capsule, cylinder or bucket. Exact outside and inside (a box or cylinder
/// pushes out through the nearest face). On a medial axis, where the nearest point is not unique, one of them is chosen by a fixed rule.
SurfacePoint distance_to_collider(const ColliderGeometry& geometry, const RigidMotion& motion, const Vec3& world_point);

}  // namespace skerry
