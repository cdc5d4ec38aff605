// Time at which features that move in straight lines meet (docs/methods/collision.md 7.2).
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "components/types.h"

namespace skerry {

/// A pair of features with four points: a point and the three corners of a triangle, or the ends of two edges.
enum class FeaturePair : std::uint8_t { point_triangle, edge_edge };

using FourPoints = std::array<Vec3, 4>;  // [m]

/// A search ends when the distance of the features is below this fraction of their distance at the start.
inline constexpr Real contact_slack = 0.1;

/// Upper bound of how much nearer any two points of the two features come while the points move by `displacement` [m].
/// Common motion does not count.
Real greatest_approach(FeaturePair kind, const FourPoints& displacement);

/// Distance to be kept between two features that are cores of round bodies.
struct KeptApart {
    Real distance = 0;                                  // sum of the radii [m]
    Real near = std::numeric_limits<Real>::infinity();  // a larger gap beyond `distance` is not in contact [m]
};

/// Time in [0, 1] at which features that move in straight lines from `position` by `displacement` come near contact, or
/// nothing if they do not. Uses additive conservative advancement (Li, Kaufman, Jiang 2021, Codimensional IPC, section
/// 5). A round also advances as long as a slab separates the features, so that sliding takes few rounds. The time is
/// never later than the contact. At that time the gap is at most `contact_slack` of the gap at the start, and at most
/// kept.near; gaps are measured beyond the kept distance. The time is 0 if the features touch at the start. After some
/// thousand rounds the search gives up and reports contact at the time reached.
std::optional<Real> time_of_contact(FeaturePair kind, const FourPoints& position, const FourPoints& displacement,
                                    const KeptApart& kept = {});

}  // namespace skerry
