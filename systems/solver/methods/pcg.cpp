#include "systems/solver/methods/pcg.h"

#include <algorithm>
#include <cmath>

#include "systems/solver/methods/pgs.h"

namespace skerry {
namespace {

/// Number of scalar rows (n in Lazarevych et al. (2010)), which limits the conjugate gradient iterations. A contact
/// without friction has one row, other contacts have three.
Index row_count(const AnyOperator& op) {
    Index rows = 0;
    for (Index i = 0; i < op.size(); ++i) rows += op.limits(i).stick > 0 ? 3 : 1;
    return rows;
}

Real largest_entry(std::span<const Vec4> vectors) {
    Real largest = 0;
    for (const Vec4& v : vectors) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    return largest;
}

/// Sets the residual r and the search direction d before the first iteration: r = d = b - A lambda, in the notation of
/// Lazarevych et al. (2010).
void start_conjugate_gradients(AnyOperator& op) {
    const std::span<Vec4> residual = op.workspace(1);
    op.residual(residual);
    for (Index i = 0; i < op.size(); ++i)
        // A contact without friction has only a normal row.
        if (op.limits(i).stick == 0) residual[i] = op.normal(i).dot(residual[i]) * op.normal(i);
    std::ranges::copy(residual, op.workspace(2).begin());
}

/// End criteria of the conjugate gradient phase that do not use the error.
struct ConjugateLimits {
    Index iterations;  // upper limit
    Real tolerance;    // tolerance in (20), (21) of Lazarevych et al. (2010); 0 switches both criteria off
};

/// Runs the conjugate gradient phase from the present impulse. The final impulse is the one that converged, otherwise
/// the best one, which may be the start. The result holds its error. The error is measured even if the number of
/// iterations is fixed, because it can grow until overflow.
SolveResult run_conjugate_gradients(AnyOperator& op, const SolveLimits& limits, const ConjugateLimits& phase,
                                    ConjugateBeta formula, ErrorTest<AnyOperator>& test) {
    if (test.ends(0)) return test.result();
    if (limits.fixed_iterations && test.result().error > suspicious_start) {
        // With a fixed number of iterations, the warm start has not been compared with zero impulses yet.
        std::ranges::fill(op.impulse(), Vec4::Zero());
        op.refresh();
        if (test.ends(0)) return test.result();
        test.restore_best();
    }
    start_conjugate_gradients(op);
    const Real first_residual = largest_entry(op.workspace(1));
    Index iteration = 0;
    bool ended = false;
    while (!ended && iteration < phase.iterations) {
        ++iteration;
        const ConjugateChange change = op.advance_gradients(formula);
        ended = change.used_up;
        if (!limits.fixed_iterations)
            ended |= change.impulse < phase.tolerance * largest_entry(op.impulse()) ||
                     change.residual < phase.tolerance * first_residual;
        if (!ended && !test.due(iteration) && iteration < phase.iterations) continue;
        op.refresh();
        if (!test.ends(iteration)) continue;
        if (!limits.fixed_iterations) return test.result();
        break;
    }
    return test.give_up(iteration);
}

}  // namespace

SolveResult solve_pcg(AnyOperator& op, const SolveLimits& limits, ConjugateBeta formula) {
    ErrorTest<AnyOperator> test(op, limits);
    const Index most = limits.fixed_iterations ? limits.max_iterations : std::min(limits.max_iterations, row_count(op));
    SolveResult result = run_conjugate_gradients(op, limits, {most, 0}, formula, test);
    if (limits.fixed_iterations) result.iterations = limits.max_iterations;
    return result;
}

SolveResult solve_pcg_pgs(AnyOperator& op, const SolveLimits& limits, ConjugateBeta formula) {
    // The tolerances of the first phase are larger than those of the second, as in Lazarevych et al. (2010): eps_cg >
    // eps_gs, delta_cg > delta_gs.
    constexpr Real looser = 10;
    ErrorTest<AnyOperator> test(op, limits);
    const ConjugateLimits phase{std::min(row_count(op), limits.max_iterations / 2), looser * limits.tolerance};
    const SolveResult first = run_conjugate_gradients(op, limits, phase, formula, test);
    if (!limits.fixed_iterations && (first.converged || !std::isfinite(first.error))) return first;
    return sweep_until_solved(op, limits, first.iterations + 1, test);
}

}  // namespace skerry
