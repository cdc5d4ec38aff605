// The paper's solver: projected conjugate gradients, then projected Gauss-Seidel from the best iterate. All convergence
// comes from the second phase (docs/methods/region_solver.md 5.1).
#pragma once

#include "systems/solver/methods/pcg.h"
#include "systems/solver/methods/pgs.h"

namespace skerry {

/// Both phases from the operator's present impulse, at most max_iterations together. The first ends by (20) or (21), by
/// its error, after as many iterations as the system has rows, or when half of the iterations are used; the second by
/// its error, which replaces (20) and (21) there so that a tolerance means the same for all methods
/// (docs/methods/contact.md 5.7). Leaves the last impulse when it converged, else the best one of both phases.
template <ContactOperator Op>
SolveResult solve_pcg_pgs(Op& op, const SolveLimits& limits, ConjugateBeta formula = ConjugateBeta::polak_ribiere) {
    // the first phase is asked for less than the second: eps_cg > eps_gs, delta_cg > delta_gs
    constexpr Real looser = 10;
    ErrorTest<Op> test(op, limits);
    const ConjugateLimits phase{std::min(row_count(op), limits.max_iterations / 2), looser * limits.tolerance};
    const SolveResult first = run_conjugate_gradients(op, limits, phase, formula, test);
    if (!limits.fixed_iterations && (first.converged || !std::isfinite(first.error))) return first;
    return sweep_until_solved(op, limits, first.iterations + 1, test);
}

}  // namespace skerry
