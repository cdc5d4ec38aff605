// Projected conjugate gradients: Algorithm 2 of the paper to the letter, with the residual (19) read as in
// docs/methods/contact.md 5.6. They stagnate where impulses meet their limits, since projecting after a step destroys
// conjugacy and descent (docs/methods/region_solver.md 5.1): the baseline to beat. Their sums run over all contacts at
// once, so separate regions and one global region do not give the same bits.
#pragma once

#include "systems/solver/methods/error_test.h"

namespace skerry {

enum class ConjugateBeta { fletcher_reeves, polak_ribiere };  // (17), (18)

/// n of the paper, after which conjugate gradients end: a contact without friction has one row.
template <ContactOperator Op>
Index row_count(const Op& op) {
    Index rows = 0;
    for (Index i = 0; i < op.size(); ++i) rows += op.limits(i).stick > 0 ? 3 : 1;
    return rows;
}

inline Real sum_of_products(std::span<const Vec4> a, std::span<const Vec4> b) {
    Real sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
}

inline Real largest_entry(std::span<const Vec4> vectors) {
    Real largest = 0;
    for (const Vec4& v : vectors) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    return largest;
}

/// Residual and direction before the first iteration, r = d = b - A lambda.
template <ContactOperator Op>
void start_conjugate_gradients(Op& op) {
    const std::span<Vec4> residual = op.workspace(1);
    op.residual(residual);
    for (Index i = 0; i < op.size(); ++i)
        // the other rows are not there
        if (op.limits(i).stick == 0) residual[i] = op.normal(i).dot(residual[i]) * op.normal(i);
    std::ranges::copy(residual, op.workspace(2).begin());
}

/// The largest entries of what one iteration left, for (20) and (21).
struct ConjugateChange {
    Real impulse = 0, residual = 0;
    bool used_up = false;  // no direction to go on in
};

/// One iteration: the impulse moves along the direction and is projected, the residual follows (19).
template <ContactOperator Op>
ConjugateChange advance_conjugate_gradients(Op& op, ConjugateBeta formula) {
    const std::span<Vec4> impulse = op.impulse(), residual = op.workspace(1), direction = op.workspace(2),
                          product = op.workspace(3);
    op.multiply(direction, product);
    const Real squared = sum_of_products(residual, residual);
    const Real curvature = sum_of_products(direction, product);
    if (!(curvature > 0) || !(squared > 0)) return {0, 0, true};
    const Real alpha = squared / curvature;
    Real squared_next = 0, with_previous = 0;
    ConjugateChange change;
    for (std::size_t i = 0; i < impulse.size(); ++i) {
        const Vec4 before = impulse[i];
        const Vec4 residual_before = residual[i];
        impulse[i] = op.project(static_cast<Index>(i), before + alpha * direction[i]);
        residual[i] = op.feasible(static_cast<Index>(i), residual_before - alpha * product[i]);
        squared_next += residual[i].dot(residual[i]);
        with_previous += residual[i].dot(residual_before);
        change.impulse = std::max(change.impulse, (impulse[i] - before).cwiseAbs().maxCoeff());
        change.residual = std::max(change.residual, residual[i].cwiseAbs().maxCoeff());
    }
    const Real numerator = formula == ConjugateBeta::fletcher_reeves ? squared_next : squared_next - with_previous;
    const Real beta = numerator / squared;
    for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = residual[i] + beta * direction[i];
    return change;
}

/// When the phase ends, beside its error.
struct ConjugateLimits {
    Index iterations;  // at most
    Real tolerance;    // (20), (21), of the largest impulse and of the first residual; 0: they end nothing
};

/// The phase from the present impulse. Leaves the impulse that converged, else the best one, its start included:
/// nothing keeps these steps from going uphill, to overflow in the end, so that a fixed count is measured by the
/// schedule, too. The result's error is that of the impulse left.
template <ContactOperator Op>
SolveResult run_conjugate_gradients(Op& op, const SolveLimits& limits, const ConjugateLimits& phase,
                                    ConjugateBeta formula, ErrorTest<Op>& test) {
    if (test.ends(0)) return test.result();
    if (limits.fixed_iterations && test.result().error > suspicious_start) {
        // nobody has asked whether zero is nearer
        std::ranges::fill(op.impulse(), Vec4::Zero());
        op.refresh();
        if (test.ends(0)) return test.result();
        test.go_back();
    }
    start_conjugate_gradients(op);
    const Real first_residual = largest_entry(op.workspace(1));
    Index iteration = 0;
    bool ended = false;
    while (!ended && iteration < phase.iterations) {
        ++iteration;
        const ConjugateChange change = advance_conjugate_gradients(op, formula);
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

/// The first phase alone, from the operator's present impulse: ends after as many iterations as there are rows. Leaves
/// the last impulse when it converged, else the best one.
template <ContactOperator Op>
SolveResult solve_pcg(Op& op, const SolveLimits& limits, ConjugateBeta formula) {
    ErrorTest<Op> test(op, limits);
    const Index most = limits.fixed_iterations ? limits.max_iterations : std::min(limits.max_iterations, row_count(op));
    SolveResult result = run_conjugate_gradients(op, limits, {most, 0}, formula, test);
    if (limits.fixed_iterations) result.iterations = limits.max_iterations;
    return result;
}

template <ContactOperator Op>
SolveResult solve_pcg_fr(Op& op, const SolveLimits& limits) {
    return solve_pcg(op, limits, ConjugateBeta::fletcher_reeves);
}
template <ContactOperator Op>
SolveResult solve_pcg_pr(Op& op, const SolveLimits& limits) {
    return solve_pcg(op, limits, ConjugateBeta::polak_ribiere);
}

}  // namespace skerry
