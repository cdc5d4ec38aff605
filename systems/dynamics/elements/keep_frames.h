// Corotational frames of a committed step, where not every block was due.
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// rotation = rotation_next of the corotational blocks that were due; the others keep the frame of their own last
/// impulse. Parallel over blocks.
void keep_frames(Executor& executor, const ElementInputs& elements, std::span<const ElementRotation> rotation_next,
                 std::span<ElementRotation> rotation);

}  // namespace skerry
