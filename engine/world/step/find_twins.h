// Search for bodies with equal meshes and elements. Stable steps and implicit elements found for one of them are valid
// for all.
#pragma once

#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// Returns for each body the row of the first body that equals it in rest shape, elements, materials, masses and held
/// nodes. If no earlier body is equal, this is the row of the body itself. Numbers are compared bitwise, and lists in
/// order.
std::vector<std::size_t> find_twins(const Model& model);

}  // namespace skerry
