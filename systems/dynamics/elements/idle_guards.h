// Finds inversion barriers (guards) that do not act (docs/methods/elasticity.md 7.7).
#pragma once

#include <algorithm>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// True if the blocks `begin` to `end` - 1 of a patch are inversion barriers (guards) and none of them acts. Tests only
/// one block for being a guard, because guards have patches of their own. A block with a guard that acts has a positive
/// viscous time.
inline bool is_idle(const ElementInputs& elements, std::size_t begin, std::size_t end) {
    return elements.part[begin] == ElementPart::guard && !elements.viscous_time.empty() &&
           std::ranges::all_of(elements.viscous_time.subspan(begin, end - begin), [](Real time) { return time == 0; });
}

}  // namespace skerry
