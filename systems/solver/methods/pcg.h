// Projected conjugate gradients: Algorithm 2 of Lazarevych et al. (2010), with equation (19) interpreted as in
// docs/methods/contact.md 5.6. The methods serve as a baseline. They stagnate when impulses reach their limits, since
// the projection after a step destroys conjugacy and descent (docs/methods/region_solver.md 5.1). Sums run over all
// contacts at once, so separate regions and one global region give different bits.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"

namespace skerry {

/// Runs only the conjugate gradient phase, from the operator's present impulse. Unless the number of iterations is
/// fixed, it does at most as many as there are scalar rows. The final impulse is the last one if it converged,
/// otherwise the best one.
SolveResult solve_pcg(AnyOperator& op, const SolveLimits& limits, ConjugateBeta formula);

/// The solver of Lazarevych et al. (2010): conjugate gradients, then projected Gauss-Seidel from the best iterate, with
/// at most max_iterations in total. All convergence comes from the second phase (docs/methods/region_solver.md 5.1).
/// The final impulse is the last one if it converged, otherwise the best one of both phases.
///
/// The first phase ends by criterion (20) or (21), by its error, after as many iterations as there are scalar rows, or
/// after half of max_iterations. The second phase ends by its error, which replaces (20) and (21) so that a tolerance
/// means the same for all methods (docs/methods/contact.md 5.7).
SolveResult solve_pcg_pgs(AnyOperator& op, const SolveLimits& limits,
                          ConjugateBeta formula = ConjugateBeta::polak_ribiere);

}  // namespace skerry
