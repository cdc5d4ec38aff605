// Search for equal bodies, with the same mesh and elements. Results for one of them hold for all.
#pragma once

#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// Returns for each body the row of the first body with equal rest shape, elements, materials, masses and held nodes;
/// the row of the body itself if no earlier body is equal. Equal means bitwise and in the same order.
std::vector<std::size_t> find_twins(const Model& model);

}  // namespace skerry
