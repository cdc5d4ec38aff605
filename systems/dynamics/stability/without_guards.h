// Selects the elements that get mass and limit the stable step: all except inversion barriers (guards), which keep
// tetrahedra from inverting (docs/methods/elasticity.md 7.7).
#pragma once

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Blocks of a body without the blocks of inversion barriers (guards), which come after all other blocks.
inline Range without_guards(const ElementInputs& elements, Range blocks) {
    while (blocks.size() > 0 && elements.part[static_cast<std::size_t>(blocks.end - 1)] == ElementPart::guard)
        --blocks.end;
    return blocks;
}

}  // namespace skerry
