// Time at which two features meet while their points move along straight lines (docs/methods/collision.md 7.2).
#pragma once

#include <array>
#include <optional>

#include "components/types.h"

namespace skerry {

/// Kinds of feature pairs. Each has four points: a point and the three corners of a triangle, or the two ends of each
/// of two edges.
enum class FeaturePair : std::uint8_t { point_triangle, edge_edge };

using FourPoints = std::array<Vec3, 4>;  // [m]

/// A search for the time of contact ends when the gap between two features has fallen below this fraction of the gap at
/// the start.
inline constexpr Real contact_slack = 0.1;

/// Upper bound of the decrease in distance between the two features [m], while the four points that define them move by
/// `displacement` [m]. The mean displacement is subtracted first, because common motion changes no distance.
Real greatest_approach(FeaturePair kind, const FourPoints& displacement);

/// Distances at which two features count as in contact. They are needed for features that are the cores (centres or
/// axes) of round bodies.
struct ContactThreshold {
    Real distance = 0;  // sum of the radii of the round bodies [m]
    // The features count as in contact if their gap, the distance beyond `distance`, is at most this value [m].
    Real near = infinity;
};

/// Time in [0, 1] at which two features are nearly in contact; no value if they stay apart. The points of the features
/// move in straight lines from `position` by `displacement`.
///
/// The gap is the distance between the features minus threshold.distance. At the returned time the features have not
/// met yet, but the gap is at most threshold.near, and at most `contact_slack` times the gap at the start. The time is
/// 0 if the features touch at the start.
///
/// The method is additive conservative advancement with separating planes (docs/methods/collision.md 7.2; Li, Kaufman,
/// Jiang 2021, Codimensional IPC, section 5). After some thousand iterations it gives up and returns the time reached.
std::optional<Real> time_of_contact(FeaturePair kind, const FourPoints& position, const FourPoints& displacement,
                                    const ContactThreshold& threshold = {});

}  // namespace skerry
