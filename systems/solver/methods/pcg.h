// Projected conjugate gradients: Algorithm 2 of the paper to the letter, with the residual (19) read as in
// docs/methods/contact.md 5.6. They stagnate where impulses meet their limits, since projecting after a step destroys
// conjugacy and descent (docs/methods/region_solver.md 5.1): the baseline to beat. Their sums run over all contacts at
// once, so separate regions and one global region do not give the same bits.
#pragma once

#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/error_test.h"

namespace skerry {

/// The first phase alone, from the operator's present impulse: ends after as many iterations as there are rows. Leaves
/// the last impulse when it converged, else the best one.
SolveResult solve_pcg(AnyOperator& op, const SolveLimits& limits, ConjugateBeta formula);

/// The paper's solver: this phase, then projected Gauss-Seidel from the best iterate. All convergence comes from the
/// second phase (docs/methods/region_solver.md 5.1). At most max_iterations together. The first ends by (20) or (21),
/// by its error, after as many iterations as the system has rows, or when half of the iterations are used; the second
/// by its error, which replaces (20) and (21) there so that a tolerance means the same for all methods
/// (docs/methods/contact.md 5.7). Leaves the last impulse when it converged, else the best one of both phases.
SolveResult solve_pcg_pgs(AnyOperator& op, const SolveLimits& limits,
                          ConjugateBeta formula = ConjugateBeta::polak_ribiere);

}  // namespace skerry
