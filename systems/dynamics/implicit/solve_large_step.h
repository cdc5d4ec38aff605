// Step of a body of large strain without contacts, by Newton's method (docs/methods/implicit_bodies.md 8).
#pragma once

#include "components/types.h"
#include "systems/dynamics/implicit/stiff_body.h"

namespace skerry {

/// Finds the velocity of stiff.large_step, starting from its present value, with
///     inertia M velocity + within dU/du(carried + within velocity) = impulse
/// for all nodes that are not held. For a free body velocities have no momenta in stiff.shape(), and U contains the
/// energy of the spin, L I^-1 L / 2. `within`: theta h [s]. The last tangent stays the matrix of stiff.respond().
/// Returns false if no velocity is found, or something is not finite.
bool solve_large_step(Real inertia, Real within, StiffBody& stiff);

}  // namespace skerry
