// Updates the memory of the elements (rotation, spring strains) after a committed step with sleeping bodies. The step
// did not write the elements of these bodies, so the columns of present and next values cannot be swapped, as they are
// after other steps.
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Sets `rotation` and `spring_strain` to their values after the step. Changes only the columns that the material of a
/// block uses. Blocks that were left out of the step stay unchanged. Parallel over blocks.
void keep_memory(Executor& executor, const ElementInputs& elements, ElementBlockTable& table);

}  // namespace skerry
