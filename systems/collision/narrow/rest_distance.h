// Distances between features of one body, measured in the rest shape of the body.
#pragma once

#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

inline Real rest_distance_squared(const CollisionInputs& inputs, Index point, const std::array<Index, 3>& corner) {
    const auto& rest = inputs.rest_position;
    return closest_point_on_triangle(rest[point], rest[corner[0]], rest[corner[1]], rest[corner[2]]).distance_squared;
}
inline Real rest_distance_squared(const CollisionInputs& inputs, const std::array<Index, 2>& a,
                                  const std::array<Index, 2>& b) {
    const auto& rest = inputs.rest_position;
    return closest_points_of_segments(rest[a[0]], rest[a[1]], rest[b[0]], rest[b[1]]).distance_squared;
}

/// True if two features of one body (a point and a triangle, or two edges) are further apart in the rest shape than 2
/// face_depth, half of the mean edge length; false if rest positions are not available.
///
/// Nearer features belong to one piece of the body, for example to the two sides of a thin part. They may pass each
/// other when an element inverts; then the elastic forces have to restore the element.
bool was_far_at_rest(const CollisionInputs& inputs, const PairScale& scale, const auto& first, const auto& second) {
    return !inputs.rest_position.empty() &&
           rest_distance_squared(inputs, first, second) > 4 * scale.face_depth * scale.face_depth;
}

}  // namespace skerry
