#include "systems/geometry/time_of_contact.h"

#include <algorithm>
#include <cmath>

#include "systems/geometry/closest_points.h"
#include "systems/geometry/conservative_advancement.h"

namespace skerry {

namespace {

/// Vector from the nearest point of the second feature to the nearest point of the first feature [m].
Vec3 offset_between(FeaturePair kind, const FourPoints& x) {
    if (kind == FeaturePair::point_triangle) return x[0] - closest_point_on_triangle(x[0], x[1], x[2], x[3]).nearest;
    const SegmentSegment nearest = closest_points_of_segments(x[0], x[1], x[2], x[3]);
    return nearest.on_first - nearest.on_second;
}

/// Fraction of `displacement` up to which a slab of thickness `threshold` perpendicular to the unit vector `normal`
/// separates the two features. Until then each point of the first feature is at least `threshold` farther along
/// `normal` than each point of the second one. The slab must separate the features at the start, where their points are
/// at `x`.
Real time_of_slab(FeaturePair kind, const FourPoints& x, const FourPoints& displacement, const Vec3& normal,
                  Real threshold) {
    const std::size_t own = kind == FeaturePair::point_triangle ? 1 : 2;
    Real least = infinity;
    for (std::size_t i = 0; i < own; ++i)
        for (std::size_t j = own; j < 4; ++j) {
            const Real approach = -normal.dot(displacement[i] - displacement[j]);
            if (approach > 0) least = std::min(least, (normal.dot(x[i] - x[j]) - threshold) / approach);
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
                                    const ContactThreshold& threshold) {
    const Real approach = greatest_approach(kind, displacement);
    FourPoints x = position;
    Vec3 offset = offset_between(kind, x);
    const Real start = offset.norm() - threshold.distance;
    if (!(start > 0)) return Real(0);
    return advance_conservatively(
        start, std::min(contact_slack * start, threshold.near),
        [&](Real gap, Real) {
            const Vec3 normal = offset / offset.norm();
            return std::max(gap / approach, time_of_slab(kind, x, displacement, normal, threshold.distance));
        },
        [&](Real time) {
            for (std::size_t i = 0; i < 4; ++i) x[i] = position[i] + time * displacement[i];
            offset = offset_between(kind, x);
            return offset.norm() - threshold.distance;
        });
}

}  // namespace skerry
