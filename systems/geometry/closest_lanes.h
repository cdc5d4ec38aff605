// Distances of several pairs of features at a time, one in each lane of a vector type T. T should fit into a register,
// because the compiler compares wider vectors lane by lane. closest_points.h has functions for a single pair, which
// also return the nearest points.
#pragma once

#include "systems/geometry/lane_vec3.h"

namespace skerry {

/// Value of x clamped to [0, 1]; 0 if x is NaN.
template <class T>
[[gnu::always_inline]] inline T clamped_to_unit(const T& x) {
    const T zero{}, one = zero + 1.0;
    const T low = x > zero ? x : zero;
    return low < one ? low : one;
}

/// Squared distances between the segments a0 a1 and b0 b1 [m^2] (Ericson, Real-Time Collision Detection, 5.1.9). The
/// result is NaN in lanes in which a coordinate is NaN.
template <class T>
[[gnu::always_inline]] inline T segment_distance_squared(const LaneVec3<T>& a0, const LaneVec3<T>& a1,
                                                         const LaneVec3<T>& b0, const LaneVec3<T>& b1) {
    // Squared sine of the angle between the two lines below which they count as parallel, because rounding errors would
    // determine where they come nearest. The position on the first segment is then taken as its start, s = 0, before it
    // is clamped.
    constexpr Real noise_sine_squared = 1e-14;
    const T zero{}, one = zero + 1.0;
    const LaneVec3<T> ea = a1 - a0, eb = b1 - b0, r = a0 - b0;
    const T a = dot(ea, ea), e = dot(eb, eb), b = dot(ea, eb), c = dot(ea, r), f = dot(eb, r);
    const T denominator = a * e - b * b;  // |ea x eb|^2
    // `s` and `t` are the positions on the two segments, as fractions of their lengths. The position where the lines
    // come nearest is clamped to the first segment, then to the second, then to the first again.
    const T crossing = clamped_to_unit((b * f - c * e) / denominator);
    const T free_s = denominator > noise_sine_squared * a * e ? crossing : zero;
    const T along = (b * free_s + f) / e, free_t = e > zero ? along : zero;
    const auto before = free_t <= zero, beyond = free_t > one;
    const T t = before ? zero : (beyond ? one : free_t);
    const T back = clamped_to_unit((t * b - c) / a), end_s = a > zero ? back : zero;
    const T s = (before | beyond) ? end_s : free_s;
    const LaneVec3<T> apart = r + s * ea - t * eb;
    return dot(apart, apart);
}

/// Squared distances of points from segments [m^2]. `from`: vector from the start of the segment to the point; `edge`:
/// vector from the start to the end of the segment [m].
template <class T>
[[gnu::always_inline]] inline T point_segment_distance_squared(const LaneVec3<T>& from, const LaneVec3<T>& edge) {
    const T zero{}, squared = dot(edge, edge);
    const T along = clamped_to_unit(dot(from, edge) / squared), s = squared > zero ? along : zero;
    const LaneVec3<T> apart = from - s * edge;
    return dot(apart, apart);
}

/// Distances of points from triangles, and heights of the points above the planes of the triangles.
template <class T>
struct PointTriangleLanes {
    T distance_squared;  // squared distance; NaN if a coordinate is NaN [m^2]
    // Height of the point above the plane, times twice the area; positive on the side of the normal [m^3].
    T scaled_height;
};

/// Distances of the points p from the triangles abc. A triangle whose smallest height is below 1e-6 of its longest edge
/// is treated as three edges without a face, because its normal would be a rounding error.
template <class T>
[[gnu::always_inline]] inline PointTriangleLanes<T> point_triangle_distance(const LaneVec3<T>& p, const LaneVec3<T>& a,
                                                                            const LaneVec3<T>& b,
                                                                            const LaneVec3<T>& c) {
    // Lower limit of the squared ratio of smallest height to longest edge. Below it, only the distances to the three
    // edges count.
    constexpr Real min_height_squared = 1e-12;
    const T zero{};
    const LaneVec3<T> ab = b - a, bc = c - b, ca = a - c, ap = p - a, bp = p - b, cp = p - c;
    const LaneVec3<T> normal = cross(ab, bc);
    const T area_squared = dot(normal, normal), height = dot(normal, ap);
    const T ab2 = dot(ab, ab), bc2 = dot(bc, bc), ca2 = dot(ca, ca);
    const T two = ab2 > bc2 ? ab2 : bc2, longest_squared = two > ca2 ? two : ca2;
    const T to_ab = point_segment_distance_squared(ap, ab), to_bc = point_segment_distance_squared(bp, bc),
            to_ca = point_segment_distance_squared(cp, ca);
    const T nearer = to_ab < to_bc ? to_ab : to_bc, to_edges = nearer < to_ca ? nearer : to_ca;
    // The foot of the perpendicular from the point is inside the triangle if the point is on the inner side of all
    // three edges.
    const auto above = (dot(cross(normal, ab), ap) > zero) & (dot(cross(normal, bc), bp) > zero) &
                       (dot(cross(normal, ca), cp) > zero) &
                       (area_squared > min_height_squared * longest_squared * longest_squared);
    const T to_plane = height * height / area_squared;
    // The comparisons above ignore NaN. Therefore a term is added that is NaN if a coordinate is NaN, and 0 otherwise.
    return {(above ? to_plane : to_edges) + 0.0 * (ab2 + bc2 + ca2), height};
}

}  // namespace skerry
