// Semismooth Newton method on the natural map of the exact Coulomb law (Alart and Curnier 1991;
// docs/methods/region_solver.md 5.6), with a dense factorisation. It is used for small regions, as an independent check
// of the other methods, and when sweeps take longer than a factorisation.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/operators/newton_memory.h"

namespace skerry {

/// The steps end when several in a row do not lower the error. A single step may raise it, as long as the sets of
/// sticking and sliding contacts are not yet correct. The function may overwrite all workspace vectors except slot 0,
/// which holds the best iterate.
SolveResult take_newton_steps(AnyOperator& op, NewtonMemory& memory, Real error, Real tolerance, Index limit);

/// Alternates sweeps and Newton steps. The number of sweeps doubles each time the Newton steps do not converge. Newton
/// steps support only the friction cone. For the pyramid, or if the number of iterations is fixed, the method does only
/// sweeps.
SolveResult solve_newton(AnyOperator& op, const SolveLimits& limits);

}  // namespace skerry
