// Updates the memory of the elements (rotation, spring strains) after a committed step with sleeping bodies, whose
// elements the step did not write. After other steps the columns of present and next values are swapped instead.
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Sets `rotation` and `spring_strain` to their values after the step. Changes only the columns that the material of a
/// block uses. Blocks that were left out of the step stay unchanged. Parallel over blocks.
void keep_memory(Executor& executor, const ElementInputs& elements, ElementBlockTable& table);

}  // namespace skerry
