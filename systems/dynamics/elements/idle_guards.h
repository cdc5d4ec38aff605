// Finds guards that do not act (docs/methods/elasticity.md 7.7).
#pragma once

#include <algorithm>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// True for the blocks of a patch of guards if none of them acts. Guards that act have a viscous time.
inline bool is_idle(const ElementInputs& elements, std::size_t begin, std::size_t end) {
    return elements.part[begin] == ElementPart::guard && !elements.viscous_time.empty() &&
           std::ranges::all_of(elements.viscous_time.subspan(begin, end - begin), [](Real time) { return time == 0; });
}

}  // namespace skerry
