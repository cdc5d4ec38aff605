// Nearest points between points, triangles and segments.
#pragma once

#include <array>

#include "components/types.h"

namespace skerry {

/// Part of a triangle that contains the nearest point.
enum class TriangleRegion : std::uint8_t { face, edge01, edge12, edge20, vertex0, vertex1, vertex2 };

struct PointTriangle {
    std::array<Real, 3> weight;  // barycentric weights of the corners: each in [0, 1], sum 1
    TriangleRegion region;
    Vec3 nearest;           // [m]
    Real distance_squared;  // [m^2]
};

/// Nearest point of triangle abc to p (Ericson, Real-Time Collision Detection, 5.1.5). A triangle without area is
/// treated as its longest edge.
PointTriangle closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

struct SegmentSegment {
    Real s, t;              // parameters of the nearest points on the first and second segment, in [0, 1]
    bool interior;          // both nearest points are inside their segments and the segments are not parallel
    Vec3 on_first;          // [m]
    Vec3 on_second;         // [m]
    Real distance_squared;  // [m^2]
};

/// Nearest points of segments a0 a1 and b0 b1 (Ericson 5.1.9). Segments with the edge vectors ea and eb count as
/// parallel if |ea x eb|^2 < 1e-6 |ea|^2 |eb|^2.
SegmentSegment closest_points_of_segments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

}  // namespace skerry
