// Distances of eight pairs of features at a time. closest_points.h has functions for a single pair, which also return
// the nearest points.
#pragma once

#include "systems/geometry/lane_vec3.h"

namespace skerry {

/// Value of x clamped to [0, 1]; 0 if x is NaN.
[[gnu::always_inline]] inline Real8 clamped_to_unit(const Real8& x) {
    const Real8 zero{}, one = zero + 1.0;
    const Real8 low = x > zero ? x : zero;
    return low < one ? low : one;
}

/// Squared distances between the segments a0 a1 and b0 b1 [m^2] (Ericson, Real-Time Collision Detection, 5.1.9). The
/// result is NaN in lanes in which a coordinate is NaN.
[[gnu::always_inline]] inline Real8 segment_distance_squared(const LaneVec3<Real8>& a0, const LaneVec3<Real8>& a1,
                                                             const LaneVec3<Real8>& b0, const LaneVec3<Real8>& b1) {
    // Squared sine of the angle between the two lines. Below this value, rounding errors determine the position where
    // the lines cross.
    constexpr Real noise_sine_squared = 1e-14;
    const Real8 zero{}, one = zero + 1.0;
    const LaneVec3<Real8> ea = a1 - a0, eb = b1 - b0, r = a0 - b0;
    const Real8 a = dot(ea, ea), e = dot(eb, eb), b = dot(ea, eb), c = dot(ea, r), f = dot(eb, r);
    const Real8 denominator = a * e - b * b;  // |ea x eb|^2
    // The parameter of the crossing is clamped on the first segment, then on the second segment, then on the first
    // segment again.
    const Real8 crossing = clamped_to_unit((b * f - c * e) / denominator);
    const Real8 free_s = denominator > noise_sine_squared * a * e ? crossing : zero;
    const Real8 along = (b * free_s + f) / e, free_t = e > zero ? along : zero;
    const auto before = free_t <= zero, beyond = free_t > one;
    const Real8 t = before ? zero : (beyond ? one : free_t);
    const Real8 back = clamped_to_unit((t * b - c) / a), end_s = a > zero ? back : zero;
    const Real8 s = (before | beyond) ? end_s : free_s;
    const LaneVec3<Real8> apart = r + s * ea - t * eb;
    return dot(apart, apart);
}

/// Squared distances of points from segments [m^2]. The segment of a point p starts at p - `from` and ends at p -
/// `from` + `edge`.
[[gnu::always_inline]] inline Real8 point_segment_distance_squared(const LaneVec3<Real8>& from,
                                                                   const LaneVec3<Real8>& edge) {
    const Real8 zero{}, squared = dot(edge, edge);
    const Real8 along = clamped_to_unit(dot(from, edge) / squared), s = squared > zero ? along : zero;
    const LaneVec3<Real8> apart = from - s * edge;
    return dot(apart, apart);
}

/// Distances of points from triangles, and heights of the points above the planes of the triangles.
struct PointTriangleLanes {
    Real8 distance_squared;  // squared distance; NaN if a coordinate is NaN [m^2]
    // Height of the point above the plane, times twice the area; positive on the side of the normal [m^3].
    Real8 height;
};

/// Distances of the points p from the triangles abc. A triangle whose height is below 1e-6 of its longest edge is
/// treated as three edges without a face.
[[gnu::always_inline]] inline PointTriangleLanes point_triangle_distance(const LaneVec3<Real8>& p,
                                                                         const LaneVec3<Real8>& a,
                                                                         const LaneVec3<Real8>& b,
                                                                         const LaneVec3<Real8>& c) {
    // Square of the smallest height of a triangle, relative to the square of its longest edge.
    constexpr Real min_height_squared = 1e-12;
    const Real8 zero{};
    const LaneVec3<Real8> ab = b - a, bc = c - b, ca = a - c, ap = p - a, bp = p - b, cp = p - c;
    const LaneVec3<Real8> normal = cross(ab, bc);
    const Real8 area_squared = dot(normal, normal), height = dot(normal, ap);
    const Real8 ab2 = dot(ab, ab), bc2 = dot(bc, bc), ca2 = dot(ca, ca);
    const Real8 two = ab2 > bc2 ? ab2 : bc2, longest_squared = two > ca2 ? two : ca2;
    const Real8 to_ab = point_segment_distance_squared(ap, ab), to_bc = point_segment_distance_squared(bp, bc),
                to_ca = point_segment_distance_squared(cp, ca);
    const Real8 nearer = to_ab < to_bc ? to_ab : to_bc, to_edges = nearer < to_ca ? nearer : to_ca;
    // The foot of the perpendicular from the point is inside the triangle if the point is on the inner side of all
    // three edges.
    const auto above = (dot(cross(normal, ab), ap) > zero) & (dot(cross(normal, bc), bp) > zero) &
                       (dot(cross(normal, ca), cp) > zero) &
                       (area_squared > min_height_squared * longest_squared * longest_squared);
    const Real8 to_plane = height * height / area_squared;
    // The comparisons above ignore NaN. The last term makes the result NaN if a coordinate is NaN, and is 0 otherwise.
    return {(above ? to_plane : to_edges) + 0.0 * (ab2 + bc2 + ca2), height};
}

}  // namespace skerry
