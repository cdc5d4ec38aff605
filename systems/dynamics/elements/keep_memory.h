// Memory of the elements after a committed step in which some bodies rested.
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// rotation and viscous_strain = those of the step, and viscous_strain_next = that of before, for the blocks that were
/// not left out and whose law or losses have them. The others keep theirs. Parallel over blocks.
void keep_memory(Executor& executor, const ElementInputs& elements, ElementBlockTable& table);

}  // namespace skerry
