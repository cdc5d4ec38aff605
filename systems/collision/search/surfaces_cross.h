// Test of whether two surfaces pass through each other.
#pragma once

#include "systems/collision/search/search_pair.h"

namespace skerry {

/// True if an edge of one surface passes through a triangle of the other. It traverses two trees whose boxes fit the
/// present positions. Touching does not count. If a body is paired with itself, features that were near each other at
/// rest do not count either.
bool surfaces_cross(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box);

}  // namespace skerry
