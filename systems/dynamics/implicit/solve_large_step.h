// Step of a body at large strain without contacts, solved by Newton's method (docs/methods/implicit_bodies.md 8).
#pragma once

#include "components/types.h"
#include "systems/dynamics/implicit/stiff_body.h"

namespace skerry {

/// Finds stiff.large_step.velocity, called v here, starting from its present value. At all nodes that are not held, v
/// satisfies
///     inertia M v + theta_h dU/du(unmoved_displacement + theta_h v) = impulse
/// with the node masses M and their coefficient `inertia`, the elastic energy U as a function of the displacements u,
/// and the members `unmoved_displacement` and `impulse` of LargeStep. `theta_h`: theta times the step length [s]. For a
/// free body U also includes the energy of the spin, L.I^-1 L / 2, with the angular momentum L and the inertia I, and v
/// has no momentum and no angular momentum in stiff.shape(). Afterwards stiff.respond() uses the matrix of the last Newton
/// iteration. Returns false if no velocity is found, or if a value is not finite.
bool solve_large_step(Real inertia, Real theta_h, StiffBody& stiff);

}  // namespace skerry
