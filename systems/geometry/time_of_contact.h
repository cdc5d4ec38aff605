// Time at which features that move in straight lines meet (docs/methods/collision.md 7.2).
#pragma once

#include <array>
#include <optional>

#include "components/types.h"

namespace skerry {

/// Kinds of pairs of features with four points: a point and the three corners of a triangle, or the ends of two edges.
enum class FeaturePair : std::uint8_t { point_triangle, edge_edge };

using FourPoints = std::array<Vec3, 4>;  // [m]

/// A search ends when the distance of the features is below this fraction of their distance at the start.
inline constexpr Real contact_slack = 0.1;

/// Upper bound of the decrease in distance between any two points of the two features while their four points move by
/// `displacement` [m]. Motion that all points share does not count.
Real greatest_approach(FeaturePair kind, const FourPoints& displacement);

/// Distance that two features keep, because they are the cores of round bodies.
struct KeptApart {
    Real distance = 0;  // sum of the radii of the round bodies [m]
    // Largest gap beyond `distance` at which the features count as in contact [m].
    Real near = infinity;
};

/// Time in [0, 1] at which two features come near contact, or nothing if they do not. Their points move in straight
/// lines from `position` by `displacement`. Uses additive conservative advancement (Li, Kaufman, Jiang 2021,
/// Codimensional IPC, section 5). An iteration also advances as long as a slab separates the features, so that sliding
/// takes few iterations. The time is never later than the contact. At that time the gap is at most `contact_slack` of
/// the gap at the start, and at most kept.near. A gap is the distance minus kept.distance. The time is 0 if the
/// features touch at the start. After some thousand iterations the search gives up and reports contact at the time
/// reached.
std::optional<Real> time_of_contact(FeaturePair kind, const FourPoints& position, const FourPoints& displacement,
                                    const KeptApart& kept = {});

}  // namespace skerry
