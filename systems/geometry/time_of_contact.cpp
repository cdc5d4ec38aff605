#include "systems/geometry/time_of_contact.h"

#include <algorithm>
#include <cmath>

#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

// Fraction of the provably contact-free motion by which one iteration advances. A fraction below 1 keeps the features
// apart in spite of rounding.
constexpr Real advance = 0.9;

// Limit of iterations. Features that need more of them roll over each other at a distance too small to be resolved in a
// step.
constexpr int most_rounds = 4096;

/// Vector between the nearest points of two features, from the second feature to the first [m].
Vec3 offset_between(FeaturePair kind, const FourPoints& x) {
    if (kind == FeaturePair::point_triangle) return x[0] - closest_point_on_triangle(x[0], x[1], x[2], x[3]).nearest;
    const SegmentSegment nearest = closest_points_of_segments(x[0], x[1], x[2], x[3]);
    return nearest.on_first - nearest.on_second;
}

/// Fraction of `displacement` until which a slab of thickness `kept`, perpendicular to `normal`, separates the two
/// features. Until then no two points of the features are nearer than `kept`. This holds for any unit normal.
Real time_of_slab(FeaturePair kind, const FourPoints& x, const FourPoints& displacement, const Vec3& normal,
                  Real kept) {
    const std::size_t own = kind == FeaturePair::point_triangle ? 1 : 2;
    Real least = std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < own; ++i)
        for (std::size_t j = own; j < 4; ++j) {
            const Real approach = -normal.dot(displacement[i] - displacement[j]);
            if (approach > 0) least = std::min(least, (normal.dot(x[i] - x[j]) - kept) / approach);
        }
    return least;
}

}  // namespace

Real greatest_approach(FeaturePair kind, const FourPoints& displacement) {
    const Vec3 mean = (displacement[0] + displacement[1] + displacement[2] + displacement[3]) / 4;
    std::array<Real, 4> squared;
    for (std::size_t i = 0; i < 4; ++i) squared[i] = (displacement[i] - mean).squaredNorm();
    const Real own = kind == FeaturePair::point_triangle ? squared[0] : std::max(squared[0], squared[1]);
    const Real other = kind == FeaturePair::point_triangle ? std::max({squared[1], squared[2], squared[3]})
                                                           : std::max(squared[2], squared[3]);
    return std::sqrt(own) + std::sqrt(other);
}

std::optional<Real> time_of_contact(FeaturePair kind, const FourPoints& position, const FourPoints& displacement,
                                    const KeptApart& kept) {
    const Real approach = greatest_approach(kind, displacement);
    FourPoints x = position;
    Vec3 offset = offset_between(kind, x);
    Real length = offset.norm(), time = 0;
    const Real start = length - kept.distance, near = std::min(contact_slack * start, kept.near);
    if (!(start > 0)) return time;
    for (int round = 0; round < most_rounds && length - kept.distance > near; ++round) {
        const Real slab = time_of_slab(kind, x, displacement, offset / length, kept.distance);
        time += advance * std::max((length - kept.distance) / approach, slab);  // infinite without motion
        if (!(time <= 1)) return std::nullopt;
        for (std::size_t i = 0; i < 4; ++i) x[i] = position[i] + time * displacement[i];
        offset = offset_between(kind, x);
        length = offset.norm();
    }
    return time;
}

}  // namespace skerry
