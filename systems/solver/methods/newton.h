// Semismooth Newton on the natural map of the exact Coulomb law (Alart and Curnier 1991;
// docs/methods/region_solver.md 5.6), with a dense factorisation: for small regions, as an independent check, and where
// sweeps go on for longer than a factorisation takes.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/operators/newton_memory.h"

namespace skerry {

/// Newton steps on F_i(r) = r_i - P(r_i - u_i / D_i), P(z) the impulse that a contact answers with to the impulse z
/// that would stop it. They end when nothing has been gained for a few of them: before the right set of sticking and
/// sliding contacts is found the error may rise. The best impulse stays. `error` is that of the present impulse. Uses
/// all of the operator's workspace but the best iterate.
SolveResult take_newton_steps(AnyOperator& op, NewtonMemory& memory, Real error, Real tolerance, Index limit);

/// Sweeps and steps in turn; twice as many sweeps each time the steps have not finished it. The steps are those of the
/// exact cone: under another law, and where the count is fixed, there are only sweeps.
SolveResult solve_newton(AnyOperator& op, const SolveLimits& limits);

}  // namespace skerry
