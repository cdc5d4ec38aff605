// Distances between features of one body at rest.
#pragma once

#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

// The limit is half of an edge: nearer features of one body, such as the two sides of a thin part, belong to the same
// piece of it. They may change places when an element inverts, which the material has to undo.
inline bool is_far_at_rest(const PairScale& scale, Real distance_squared) {
    return distance_squared > 4 * scale.face_depth * scale.face_depth;
}

inline bool was_far_at_rest(const CollisionInputs& inputs, const PairScale& scale, Index point,
                            const std::array<Index, 3>& corner) {
    if (inputs.rest_position.empty()) return false;
    const auto& rest = inputs.rest_position;
    return is_far_at_rest(
        scale,
        closest_point_on_triangle(rest[point], rest[corner[0]], rest[corner[1]], rest[corner[2]]).distance_squared);
}

inline bool was_far_at_rest(const CollisionInputs& inputs, const PairScale& scale, const std::array<Index, 2>& a,
                            const std::array<Index, 2>& b) {
    if (inputs.rest_position.empty()) return false;
    const auto& rest = inputs.rest_position;
    return is_far_at_rest(scale,
                          closest_points_of_segments(rest[a[0]], rest[a[1]], rest[b[0]], rest[b[1]]).distance_squared);
}

}  // namespace skerry
