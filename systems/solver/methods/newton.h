// Semismooth Newton on the natural map of the exact Coulomb law (Alart and Curnier 1991; docs/methods/region_solver.md
// 5.6), with a dense factorisation. Used for small regions, as an independent check, and when sweeps take longer than a
// factorisation.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/operators/newton_memory.h"

namespace skerry {

/// Newton steps on F_i(r) = r_i - P(r_i - u_i / D_i), where P(z) is the impulse of the contact law if z would stop the
/// contact. Ends when several steps gain nothing: the error may rise before the right sets of sticking and sliding
/// contacts are found. The best impulse is kept. `error` is that of the present impulse. Uses the whole workspace
/// except the best iterate.
SolveResult take_newton_steps(AnyOperator& op, NewtonMemory& memory, Real error, Real tolerance, Index limit);

/// Alternates sweeps and Newton steps; doubles the sweeps each time the steps do not converge. The steps assume the
/// exact cone: with another law or a fixed count there are only sweeps.
SolveResult solve_newton(AnyOperator& op, const SolveLimits& limits);

}  // namespace skerry
