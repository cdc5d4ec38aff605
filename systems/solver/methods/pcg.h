// Projected conjugate gradients, a baseline for comparisons: Algorithm 2 of Lazarevych et al. (2010), read as in
// docs/methods/contact.md 5.5, 5.6. They stagnate when impulses reach their limits, since the projection after a step
// destroys conjugacy and descent.
//
// Sums run over all contacts at once, so separate regions and one global region give different bits.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"

namespace skerry {

/// Runs only the conjugate gradient phase, from the operator's present impulse. It takes at most as many iterations as
/// there are scalar rows, unless their number is fixed. The final impulse is the last one if it converged, otherwise
/// the best one.
SolveResult solve_pcg(AnyOperator& op, const SolveLimits& limits, ConjugateBeta formula);

/// The solver of Lazarevych et al. (2010), with at most max_iterations in its two phases together:
/// 1. Conjugate gradients end by criterion (20) or (21), by the error, after as many iterations as there are scalar
///    rows, or after half of max_iterations.
/// 2. Projected Gauss-Seidel from the best iterate ends by the error, which replaces (20) and (21) so that a tolerance
///    means the same for all methods (docs/methods/contact.md 5.7). All convergence comes from this phase.
///
/// The final impulse is the last one if it converged, otherwise the best one of both phases.
SolveResult solve_pcg_pgs(AnyOperator& op, const SolveLimits& limits,
                          ConjugateBeta formula = ConjugateBeta::polak_ribiere);

}  // namespace skerry
