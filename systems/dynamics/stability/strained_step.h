// How long a step a strained body stands by mass forms where few of its elements have stiffened, or where they have in
// places only (docs/methods/stable_step.md 2.5).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

struct StrainedLook {
    Real asked;   // s, longer steps need not be known
    Real stands;  // s, that the body stands for certain, by what else is known: springs relax in it
};

/// Numbers that strained_step needs to work in.
std::size_t strained_step_memory(Range nodes, Range blocks);

/// s, that the explicit elements of a body with mass forms stand in this shape, if that is more than `stands`. Elements
/// that need no more than the forms give them for steps near `asked` count once, all together; what the others have
/// more is a matrix of its own, whose rows bound it. `nodes` has all nodes of the elements. Sequential.
Real strained_step(const ElementInputs& elements, Range blocks, Range nodes, std::span<const Vec3> position,
                   std::span<const Real> mass, const StrainedLook& look, std::span<Real> memory);

}  // namespace skerry
