// Nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe, Erleben 2010; methods.md 2.6): a sweep of Gauss-Seidel is the gradient step of
// Fletcher and Reeves. It is the paper's idea, conjugate gradients and Gauss-Seidel together, the other way about.
#pragma once

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

/// Sweeps from the operator's present impulse. Leaves the last impulse when it converged or the count is fixed, else the best one.
template <ContactOperator Op>
SolveResult solve_nncg(Op& op, const SolveLimits& limits) {
    BestIterate<Op> best(op);
    const std::span<Vec4> impulse = op.impulse(), start = op.workspace(1), direction = op.workspace(2);
    std::fill(direction.begin(), direction.end(), Vec4(Vec4::Zero()));
    Real change_before = 0;
    Index check = 1;
    for (Index iteration = 1; iteration <= limits.max_iterations; ++iteration) {
        std::ranges::copy(impulse, start.begin());
        const Real change = op.sweep(limits.relaxation);                     // |g|^2, g = start - swept, in the norm of the diagonal blocks
        const bool suggested = op.suggests_check(change, limits.tolerance);  // once a sweep
        const bool due = suggested || iteration >= check || iteration == limits.max_iterations;
        if (due && !limits.fixed_iterations) {
            const Real error = op.error();
            if (error <= limits.tolerance) return {iteration, error, true};
            if (!std::isfinite(error)) return {iteration, error, false};
            best.offer(error);
            if (iteration >= check) check = next_check(iteration);
        }
        if (iteration == limits.max_iterations) break;

        // a gradient that grows ends the conjugacy: the sweep stands alone, and the next starts from no direction. Keeping the gradient as
        // the first direction instead takes up to seven times the sweeps on stacks
        const bool turned = change_before > 0 && change > change_before;
        const Real beta = change_before > 0 && !turned ? change / change_before : 0;
        change_before = change;
        for (std::size_t i = 0; i < impulse.size(); ++i) {
            direction[i] = turned ? Vec4(Vec4::Zero()) : Vec4(beta * direction[i] + (impulse[i] - start[i]));
            if (!turned) impulse[i] = start[i] + direction[i];
        }
        if (beta > 0) op.refresh();
    }
    if (!limits.fixed_iterations) return {limits.max_iterations, best.restore(), false};
    const Real error = op.error();
    return {limits.max_iterations, error, error <= limits.tolerance};
}

}  // namespace skerry
