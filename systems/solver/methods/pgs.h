// Block projected Gauss-Seidel: the paper's (14), (15) with the exact solution of each contact in its turn.
#pragma once

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

/// Sweeps `first` .. max_iterations over the contacts in order, from the operator's present impulse. Leaves the last impulse when it
/// converged or the count is fixed, else the best one.
template <ContactOperator Op>
SolveResult sweep_until_solved(Op& op, const SolveLimits& limits, Index first, BestIterate<Op>& best) {
    Index check = first;
    for (Index iteration = first; iteration <= limits.max_iterations; ++iteration) {
        const Real change = op.sweep(limits.relaxation);
        if (limits.fixed_iterations) continue;
        const bool suggested = op.suggests_check(change, limits.tolerance);  // once a sweep
        if (!suggested && iteration < check && iteration < limits.max_iterations) continue;
        const Real error = op.error();
        if (error <= limits.tolerance) return {iteration, error, true};
        if (!std::isfinite(error)) return {iteration, error, false};
        best.offer(error);
        if (iteration >= check) check = next_check(iteration);
    }
    if (!limits.fixed_iterations) return {limits.max_iterations, best.restore(), false};
    const Real error = op.error();
    return {limits.max_iterations, error, error <= limits.tolerance};
}

template <ContactOperator Op>
SolveResult solve_pgs(Op& op, const SolveLimits& limits) {
    BestIterate<Op> best(op);
    return sweep_until_solved(op, limits, 1, best);
}

}  // namespace skerry
