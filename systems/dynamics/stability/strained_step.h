// Stable step of a strained body with mass forms, sharper if few of its elements have stiffened, or only some regions
// (docs/methods/stable_step.md 2.5).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

struct StrainedLook {
    Real asked;   // longer steps need not be known [s]
    Real stands;  // step known to be stable by other bounds; springs relax in it [s]
};

/// Length of the work memory of strained_step().
std::size_t strained_step_memory(Range nodes, Range blocks);

/// Stable step of the explicit elements of a body with mass forms in this shape [s]; valid if it is more than
/// `look.stands`. Elements that need no more than the forms give them for steps near `look.asked` count once, all
/// together. The excess of the others is a matrix of its own, whose rows bound it. `nodes` has all nodes of the
/// elements. Sequential.
Real strained_step(const ElementInputs& elements, Range blocks, Range nodes, std::span<const Vec3> position,
                   std::span<const Real> mass, const StrainedLook& look, std::span<Real> memory);

}  // namespace skerry
