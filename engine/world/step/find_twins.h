// Bodies of one mesh, whose elements are alike: what is found for one of them holds for all.
#pragma once

#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// By body, the first (row) that has the same elements, materials and masses, and the same nodes held, at rest: itself
/// where none before it has. To the last bit, and in the same order.
std::vector<std::size_t> find_twins(const Model& model);

}  // namespace skerry
