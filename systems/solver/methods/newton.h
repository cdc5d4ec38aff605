// Semismooth Newton method for the exact Coulomb law, with a dense factorisation (Alart and Curnier 1991;
// docs/methods/region_solver.md 5.6). It is used for small regions, when sweeps take longer than a factorisation, and
// as an independent check of the other methods.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/operators/newton_memory.h"

namespace skerry {

/// Takes at most `limit` Newton steps from the present impulse, whose error is `error`. They end early if several in a
/// row do not lower the error; a single step may raise it. The function may overwrite all workspace vectors except slot
/// 0, which holds the best iterate of the caller.
SolveResult take_newton_steps(AnyOperator& op, NewtonMemory& memory, Real error, Real tolerance, Index limit);

/// Alternates sweeps and Newton steps. The number of sweeps doubles each time the Newton steps do not converge. Newton
/// steps support only the friction cone. For the pyramid, or if the number of iterations is fixed, the method does only
/// sweeps.
SolveResult solve_newton(AnyOperator& op, const SolveLimits& limits);

}  // namespace skerry
