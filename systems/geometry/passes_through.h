// Test for whether a segment passes through a triangle.
#pragma once

#include <Eigen/Geometry>

#include "components/types.h"

namespace skerry {

/// Six times the signed volume of the tetrahedron abcd. It is positive if d lies on the side of the triangle abc to
/// which the normal (b - a) x (c - a) points.
inline Real orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
}

/// True if the segment pq passes through the interior of the triangle abc from one side to the other.
inline bool passes_through(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    if (!(orientation(a, b, c, p) * orientation(a, b, c, q) < 0)) return false;
    const Real u = orientation(p, q, a, b), v = orientation(p, q, b, c), w = orientation(p, q, c, a);
    return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

}  // namespace skerry
