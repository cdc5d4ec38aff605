// Nearest points of a point and a triangle, and of two segments.
#pragma once

#include <array>

#include "components/types.h"

namespace skerry {

/// Part of a triangle in which the nearest point lies.
enum class TriangleRegion : std::uint8_t { face, edge01, edge12, edge20, vertex0, vertex1, vertex2 };

struct PointTriangle {
    std::array<Real, 3> weight;  // barycentric weights of the corners: each weight is in [0, 1], their sum is 1
    TriangleRegion region;
    Vec3 nearest;           // [m]
    Real distance_squared;  // [m^2]
};

/// The point of triangle abc that is nearest to p (Ericson, Real-Time Collision Detection, 5.1.5). A triangle whose
/// smallest height is below 1e-6 of its longest edge is treated as this edge.
PointTriangle closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

struct SegmentSegment {
    Real s, t;              // parameters, in [0, 1], of the nearest points along the first and second segment
    bool interior;          // true: both nearest points are inside their segments, and the segments are not parallel
    Vec3 on_first;          // [m]
    Vec3 on_second;         // [m]
    Real distance_squared;  // [m^2]
};

/// Nearest points of the segments a0 a1 and b0 b1 (Ericson 5.1.9). Two segments with edge vectors ea and eb count as
/// parallel if |ea x eb|^2 < 1e-6 |ea|^2 |eb|^2.
SegmentSegment closest_points_of_segments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

}  // namespace skerry
