// Bodies with one mesh and equal elements: results for one of them hold for all.
#pragma once

#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// For each body the first body (row) with the same elements, materials, masses and held nodes at rest; itself if no
/// earlier one has them. They must agree bitwise and in order.
std::vector<std::size_t> find_twins(const Model& model);

}  // namespace skerry
