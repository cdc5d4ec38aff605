// Whether two surfaces go through each other.
#pragma once

#include "systems/collision/search/search_pair.h"

namespace skerry {

/// Whether an edge of one surface goes through a triangle of the other, by two trees whose boxes fit the present
/// positions. What only touches does not count. In a body's pair with itself features that were near each other at rest
/// do not count either.
bool surfaces_cross(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box);

}  // namespace skerry
