#include "systems/geometry/closest_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

// A triangle whose smallest height is below this fraction of its longest edge is treated as the edge alone. With a
// limit of 1e-8 instead, the sub-areas computed below could lose all digits.
constexpr Real min_height_fraction = 1e-6;

// Segments count as parallel if the squared sine of the angle between them is below this value, because small changes
// of their directions then move the nearest points far.
constexpr Real min_sine_squared = 1e-6;

// If the squared sine of the angle between two segments is below this value, the denominator in the formula for their
// nearest points is only a rounding error.
constexpr Real noise_sine_squared = 1e-14;

Real clamp01(Real x) {
    return std::clamp(x, Real(0), Real(1));
}

PointTriangle at(const Vec3& p, const Vec3& nearest, TriangleRegion region, Real w0, Real w1, Real w2) {
    return {{w0, w1, w2}, region, nearest, (p - nearest).squaredNorm()};
}

/// Nearest point of a degenerate triangle, which is treated as its longest edge.
PointTriangle closest_point_on_flat_triangle(const Vec3& p, const std::array<Vec3, 3>& corner) {
    constexpr std::array<TriangleRegion, 3> edge_region{TriangleRegion::edge01, TriangleRegion::edge12,
                                                        TriangleRegion::edge20};
    constexpr std::array<TriangleRegion, 3> vertex_region{TriangleRegion::vertex0, TriangleRegion::vertex1,
                                                          TriangleRegion::vertex2};
    std::size_t longest = 0;
    Real length_squared = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const Real candidate = (corner[(k + 1) % 3] - corner[k]).squaredNorm();
        if (candidate > length_squared) {
            length_squared = candidate;
            longest = k;
        }
    }
    const std::size_t next = (longest + 1) % 3;
    const Vec3 along = corner[next] - corner[longest];
    const Real s = length_squared > 0 ? clamp01((p - corner[longest]).dot(along) / length_squared) : 0;
    std::array<Real, 3> weight{0, 0, 0};
    weight[longest] = 1 - s;
    weight[next] = s;
    const TriangleRegion region = s <= 0 ? vertex_region[longest] : s >= 1 ? vertex_region[next] : edge_region[longest];
    return at(p, corner[longest] + s * along, region, weight[0], weight[1], weight[2]);
}

}  // namespace

PointTriangle closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const Real longest_squared = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
    // Twice the area equals height times longest edge. The condition is written so that it is also true for NaN.
    if (!(ab.cross(ac).squaredNorm() > min_height_fraction * min_height_fraction * longest_squared * longest_squared))
        return closest_point_on_flat_triangle(p, {a, b, c});

    // Method of Ericson 5.1.5: the signs of projections on the edges and of sub-areas show which part of the triangle
    // is nearest.
    const Real d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return at(p, a, TriangleRegion::vertex0, 1, 0, 0);
    const Real d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return at(p, b, TriangleRegion::vertex1, 0, 1, 0);
    const Real vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const Real s = d1 / (d1 - d3);
        return at(p, a + s * ab, TriangleRegion::edge01, 1 - s, s, 0);
    }
    const Real d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return at(p, c, TriangleRegion::vertex2, 0, 0, 1);
    const Real vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const Real s = d2 / (d2 - d6);
        return at(p, a + s * ac, TriangleRegion::edge20, 1 - s, 0, s);
    }
    const Real va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const Real s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return at(p, b + s * (c - b), TriangleRegion::edge12, 0, 1 - s, s);
    }
    const Real scale = 1 / (va + vb + vc);
    // Near an edge, rounding errors can make a weight negative. Such a weight is set to zero, because the sign of a
    // weight in the stencil of a contact tells to which of the two bodies the node belongs.
    const Real v = std::max(Real(0), vb * scale), w = std::max(Real(0), vc * scale);
    return at(p, a + v * ab + w * ac, TriangleRegion::face, std::max(Real(0), 1 - v - w), v, w);
}

SegmentSegment closest_points_of_segments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
    const Vec3 ea = a1 - a0, eb = b1 - b0, r = a0 - b0;
    const Real a = ea.squaredNorm(), e = eb.squaredNorm(), b = ea.dot(eb), c = ea.dot(r), f = eb.dot(r);
    const Real denominator = a * e - b * b;  // |ea x eb|^2
    // Method of Ericson 5.1.9: the position where the lines come nearest is clamped to the first segment, then to the
    // second, then to the first again.
    Real s = denominator > noise_sine_squared * a * e ? clamp01((b * f - c * e) / denominator) : 0;
    Real t = e > 0 ? (b * s + f) / e : 0;
    if (t < 0 || !(e > 0)) {
        t = 0;
        s = a > 0 ? clamp01(-c / a) : 0;
    } else if (t > 1) {
        t = 1;
        s = a > 0 ? clamp01((b - c) / a) : 0;
    }
    SegmentSegment result;
    result.s = s;
    result.t = t;
    result.interior = s > 0 && s < 1 && t > 0 && t < 1 && denominator >= min_sine_squared * a * e;
    result.on_first = a0 + s * ea;
    result.on_second = b0 + t * eb;
    result.distance_squared = (result.on_first - result.on_second).squaredNorm();
    return result;
}

}  // namespace skerry
