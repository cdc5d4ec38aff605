// Intersection of rays with analytic shapes, in closed form.
#pragma once

#include <optional>

#include "components/collider_table.h"
#include "systems/collision/query/surface_query.h"

namespace skerry {

struct ShapePoint {
    Real distance;  // [m]
    Vec3 normal;    // unit, outward, world frame
};

/// First intersection of a ray with the surface of a plane, sphere, box, capsule, cylinder or bucket, from either side,
/// at no more than `limit` [m]. A ray within a flat side does not meet that side.
std::optional<ShapePoint> cast_ray(const ColliderGeometry& geometry, const RigidMotion& motion, const Ray& ray,
                                   Real limit);

}  // namespace skerry
