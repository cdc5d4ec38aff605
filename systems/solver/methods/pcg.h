// Projected conjugate gradients: Algorithm 2 of the paper, with the residual (19) read as in docs/methods/contact.md
// 5.6. They are a baseline: they stagnate when impulses reach their limits, since projection after a step destroys
// conjugacy and descent (docs/methods/region_solver.md 5.1). Their sums run over all contacts at once, so separate
// regions and one global region give different bits.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"

namespace skerry {

/// First phase only, from the operator's present impulse. Ends after at most as many iterations as there are rows.
/// Leaves the last impulse if it converged, otherwise the best one.
SolveResult solve_pcg(AnyOperator& op, const SolveLimits& limits, ConjugateBeta formula);

/// The paper's solver: conjugate gradients, then projected Gauss-Seidel from the best iterate, at most max_iterations
/// together. All convergence comes from the second phase (docs/methods/region_solver.md 5.1). The first phase ends by
/// (20) or (21), by its error, after as many iterations as the system has rows, or at half of the iterations. The
/// second ends by its error, which replaces (20) and (21) so that a tolerance means the same for all methods
/// (docs/methods/contact.md 5.7). Leaves the last impulse if it converged, otherwise the best one of both phases.
SolveResult solve_pcg_pgs(AnyOperator& op, const SolveLimits& limits,
                          ConjugateBeta formula = ConjugateBeta::polak_ribiere);

}  // namespace skerry
