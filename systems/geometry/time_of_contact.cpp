#include "systems/geometry/time_of_contact.h"

#include <algorithm>
#include <cmath>

#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

// Fraction of the way that surely is free which is taken at once. The rest keeps the features apart whatever the
// rounding.
constexpr Real advance = 0.9;

// Each round takes 0.9 of the distance; what needs more slides along for longer than a step is worth.
constexpr int most_rounds = 4096;

Real distance(FeaturePair kind, const FourPoints& x) {
    const Real squared = kind == FeaturePair::point_triangle
                             ? closest_point_on_triangle(x[0], x[1], x[2], x[3]).distance_squared
                             : closest_points_of_segments(x[0], x[1], x[2], x[3]).distance_squared;
    return std::sqrt(squared);
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
    const Real start = distance(kind, position) - kept.distance, near = std::min(contact_slack * start, kept.near);
    Real time = 0, apart = start;
    for (int round = 0; round < most_rounds; ++round) {
        if (!(apart > near) || !(start > 0)) return time;
        time += advance * apart / approach;  // infinite without motion
        if (!(time <= 1)) break;
        FourPoints x;
        for (std::size_t i = 0; i < 4; ++i) x[i] = position[i] + time * displacement[i];
        apart = distance(kind, x) - kept.distance;
    }
    if (time <= 1) return time;
    return std::nullopt;
}

}  // namespace skerry
