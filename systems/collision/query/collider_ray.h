// Intersection of rays with analytic shapes, in closed form.
#pragma once

#include <optional>

#include "components/collider_table.h"
#include "systems/collision/query/surface_query.h"

namespace skerry {

struct ShapePoint {
    Real distance;  // [m]
    Vec3 normal;    // unit outward normal in the world frame
};

/// First intersection of a ray with the surface of a plane, sphere, box, capsule, cylinder or bucket, at a distance of
/// at most `limit` [m]. The ray may hit the surface from either side. A ray that lies in a flat side does not hit this
/// side.
std::optional<ShapePoint> cast_ray(const ColliderGeometry& geometry, const RigidMotion& motion, const Ray& ray,
                                   Real limit);

}  // namespace skerry
