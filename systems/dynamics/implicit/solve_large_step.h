// Step of a body at large strain without contacts, solved by Newton's method (docs/methods/implicit_bodies.md 8).
#pragma once

#include "components/types.h"
#include "systems/dynamics/implicit/stiff_body.h"

namespace skerry {

/// Solves a step at large strain by Newton's method (docs/methods/implicit_bodies.md 8). The result is the node
/// velocity v = stiff.large_step.velocity; its present value is the start. Afterwards stiff.respond() uses the matrix
/// of the last iteration. Returns false if no velocity is found, or if a value is not finite.
///
/// With the node masses M, the elastic energy U(u) at the displacements u, and `theta_h`, theta times the step length
/// [s], v satisfies at all nodes that are not held
///     inertia M v + theta_h dU/du(unmoved_displacement + theta_h v) = impulse
/// `impulse` and `unmoved_displacement` are members of LargeStep. For a free body U includes the energy of the spin,
/// and v has no momentum and no angular momentum in stiff.shape().
bool solve_large_step(Real inertia, Real theta_h, StiffBody& stiff);

}  // namespace skerry
