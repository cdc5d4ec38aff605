// The step of a body of large strain without contacts, by Newton's method (docs/methods/implicit_bodies.md 8).
#pragma once

#include "components/types.h"
#include "systems/dynamics/implicit/stiff_body.h"

namespace skerry {

/// Finds the velocity of stiff.large_step, from what it is, with
///     inertia M velocity + within dU/du(carried + within velocity) = impulse
/// of all nodes that are not held, and, where none is, of what has no momenta in stiff.shape(), with the energy of its
/// spin, L I^-1 L / 2, in U. `within`: s, theta h. The last
/// tangent stays the matrix of stiff.respond(). Returns false where it is not found, or something is not finite.
bool solve_large_step(Real inertia, Real within, StiffBody& stiff);

}  // namespace skerry
