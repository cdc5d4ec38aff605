// Step of a body at large strain without contacts, solved by Newton's method (docs/methods/implicit_bodies.md 8).
#pragma once

#include "components/types.h"
#include "systems/dynamics/implicit/stiff_body.h"

namespace skerry {

/// Finds the velocity v of stiff.large_step, starting from its present value. For all nodes that are not held v
/// satisfies
///     inertia M v + within dU/du(carried + within v) = impulse
/// with the node masses M, the elastic energy U, and the members `carried` and `impulse` of LargeStep. For a free body
/// v has no momentum and no angular momentum in stiff.shape(), and U includes the energy of the spin, L.I^-1 L / 2,
/// with angular momentum L and inertia I. `within`: theta times the step length [s]. The last tangent remains the
/// matrix of stiff.respond(). Returns false if no velocity is found, or if a value is not finite.
bool solve_large_step(Real inertia, Real within, StiffBody& stiff);

}  // namespace skerry
