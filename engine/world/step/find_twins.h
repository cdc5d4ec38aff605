// Search for bodies with equal meshes and elements. Implicit elements and stable steps that are found for one of these
// bodies hold for all of them.
#pragma once

#include <vector>

#include "engine/world/state/model.h"

namespace skerry {

/// Returns for each body the row of the first body that equals it in rest shape, elements, materials, masses and held
/// nodes. This may be the body itself. Numbers are compared bitwise, and lists entry by entry.
std::vector<std::size_t> find_twins(const Model& model);

}  // namespace skerry
