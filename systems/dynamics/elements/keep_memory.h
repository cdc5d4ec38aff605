// What the elements remember of a committed step, where not every block was due.
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// rotation and viscous_strain = those of the step, of the blocks that were due and whose law or losses have them, and
/// viscous_strain_next = that of before; the others keep those of their own last impulse. Parallel over blocks.
void keep_memory(Executor& executor, const ElementInputs& elements, ElementBlockTable& table);

}  // namespace skerry
