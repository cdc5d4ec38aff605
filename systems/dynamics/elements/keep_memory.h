// Memory of the elements after a committed step in which some bodies were asleep.
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Sets rotation and viscous_strain to those of the step, and viscous_strain_next to the one before the step, for
/// blocks that were not left out and whose law or losses use them. Other blocks stay as they are. Parallel over blocks.
void keep_memory(Executor& executor, const ElementInputs& elements, ElementBlockTable& table);

}  // namespace skerry
