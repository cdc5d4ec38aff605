// When features that move in straight lines come together (docs/methods/collision.md 7.2).
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "components/types.h"

namespace skerry {

/// A pair of features of four points: a point and the three corners of a triangle, or the two ends of either segment.
enum class FeaturePair : std::uint8_t { point_triangle, edge_edge };

using FourPoints = std::array<Vec3, 4>;  // m

/// A search ends when the features are nearer than this fraction of their distance at the start.
inline constexpr Real contact_slack = 0.1;

/// m: no two points of the two features come nearer to each other by more than this while the points move by
/// `displacement`. Common motion does not count.
Real greatest_approach(FeaturePair kind, const FourPoints& displacement);

/// How near two features may come where they are cores of round bodies.
struct KeptApart {
    Real distance = 0;                                  // m, the radii
    Real near = std::numeric_limits<Real>::infinity();  // m: what is further from that is not in contact
};

/// The time in [0, 1] at which features that move from `position` by `displacement` in straight lines are near contact,
/// or nothing when they do not come as near. Additive conservative advancement (Li, Kaufman, Jiang 2021, Codimensional
/// IPC, section 5), and as far as the features stay on their sides of where they are nearest, so that sliding along
/// takes few rounds: never later than the contact, and at that time they are nearer than `contact_slack` of the
/// distance at the start, all distances beyond the one that is kept. 0 when they touch at the start. What takes some
/// thousand rounds is given up as contact at the time reached.
std::optional<Real> time_of_contact(FeaturePair kind, const FourPoints& position, const FourPoints& displacement,
                                    const KeptApart& kept = {});

}  // namespace skerry
