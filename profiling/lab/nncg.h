// Nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe, Erleben 2010; docs/methods/region_solver.md 5.2): a
// Gauss-Seidel sweep is the gradient step of Fletcher and Reeves. The paper also combines conjugate gradients with
// Gauss-Seidel, but with the roles reversed.
#pragma once

#include <algorithm>

#include "systems/solver/methods/error_test.h"

namespace skerry::lab {

/// Solves from the present impulse of the operator. Leaves the last impulse if it converged or the iteration count is
/// fixed, else the best one.
template <ContactOperator Op>
SolveResult solve_nncg(Op& op, const SolveLimits& limits) {
    ErrorTest<Op> test(op, limits);
    const std::span<Vec4> impulse = op.impulse(), start = op.workspace(1), direction = op.workspace(2);
    std::fill(direction.begin(), direction.end(), Vec4(Vec4::Zero()));
    Real change_before = 0;
    for (Index iteration = 1; iteration <= limits.max_iterations; ++iteration) {
        std::ranges::copy(impulse, start.begin());
        // |g|^2, g = start - swept, in the norm of the diagonal blocks
        const Real change = op.sweep(limits.relaxation);
        if (test.ends_after_sweep(iteration, change, limits.max_iterations)) return test.result();
        if (iteration == limits.max_iterations) break;

        // A growing gradient ends the conjugacy: the sweep is taken without a direction, and so is the next. Keeping
        // the gradient as the first direction instead takes up to seven times the sweeps on stacks.
        const bool turned = change_before > 0 && change > change_before;
        const Real beta = change_before > 0 && !turned ? change / change_before : 0;
        change_before = change;
        for (std::size_t i = 0; i < impulse.size(); ++i) {
            direction[i] = turned ? Vec4(Vec4::Zero()) : Vec4(beta * direction[i] + (impulse[i] - start[i]));
            if (!turned) impulse[i] = start[i] + direction[i];
        }
        if (beta > 0) op.refresh();
    }
    return test.give_up(limits.max_iterations);
}

}  // namespace skerry::lab
