// Stable step of a strained body with mass forms (mass_forms.h). The bound is sharper than that of stable_step() if
// only few elements, or only the elements of some regions, have stiffened (docs/methods/stable_step.md 2.5).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

struct StableStepGoal {
    Real longest;  // longest step of interest; a longer result is of no use [s]
    Real stable;   // step known to be stable from other bounds; springs relax for this time [s]
};

/// Number of entries in the work memory of strained_step().
std::size_t strained_step_memory(Range nodes, Range blocks);

/// Stable step of the explicit elements of a body with mass forms, in the present shape [s]. `nodes`: range of all
/// nodes of the elements. Sequential.
///
/// The result is valid only if it is longer than `goal.stable`. Springs of viscoelastic materials (Maxwell elements)
/// are assumed to relax for this time; in a shorter step they would relax less and be stiffer.
///
/// One number, the base, bounds omega^2 of most elements: those that are stable in steps near `goal.longest`. For the
/// other elements the excess of omega^2 over the base is added up in a matrix, which is bounded by its row sums
/// (docs/methods/stable_step.md 2.5).
Real strained_step(const ElementInputs& elements, Range blocks, Range nodes, std::span<const Vec3> position,
                   std::span<const Real> mass, const StableStepGoal& goal, std::span<Real> memory);

}  // namespace skerry
