// The paper's Algorithm 2: projected conjugate gradients, then projected Gauss-Seidel from the best iterate. It is the baseline: the first
// phase stagnates, since projecting after a step destroys conjugacy (methods.md 1.3 f).
#pragma once

#include "systems/solver/methods/pgs.h"

namespace skerry {

enum class ConjugateBeta { fletcher_reeves, polak_ribiere };  // (17), (18)

/// Iterations of the first phase. The paper stops after as many as the system has rows; 50 is the cap of the measurements in methods.md 2.5
/// (it has stagnated by then), and half of all iterations are left to the phase that converges.
inline Index conjugate_gradient_limit(Index contacts, Index max_iterations) {
    return std::min({3 * contacts, Index(50), max_iterations / 2});
}

inline Real sum_of_products(std::span<const Vec4> a, std::span<const Vec4> b) {
    Real sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
}

/// One iteration: the impulse moves along the direction and is projected, the residual follows (19). Writes the largest entries of both
/// changes for (20), (21). Returns false when the direction is used up.
template <ContactOperator Op>
bool advance_conjugate_gradients(Op& op, ConjugateBeta formula, Real& impulse_change, Real& residual_size) {
    const std::span<Vec4> impulse = op.impulse(), residual = op.workspace(1), direction = op.workspace(2), product = op.workspace(3);
    op.multiply(direction, product);
    const Real squared = sum_of_products(residual, residual);
    const Real curvature = sum_of_products(direction, product);
    if (!(curvature > 0) || !(squared > 0)) return false;
    const Real alpha = squared / curvature;
    Real squared_next = 0, with_previous = 0;
    impulse_change = residual_size = 0;
    for (std::size_t i = 0; i < impulse.size(); ++i) {
        const Vec4 before = impulse[i];
        const Vec4 residual_before = residual[i];
        impulse[i] = op.project(static_cast<Index>(i), before + alpha * direction[i]);
        residual[i] = op.feasible(static_cast<Index>(i), residual_before - alpha * product[i]);
        squared_next += residual[i].dot(residual[i]);
        with_previous += residual[i].dot(residual_before);
        impulse_change = std::max(impulse_change, (impulse[i] - before).cwiseAbs().maxCoeff());
        residual_size = std::max(residual_size, residual[i].cwiseAbs().maxCoeff());
    }
    const Real numerator = formula == ConjugateBeta::fletcher_reeves ? squared_next : squared_next - with_previous;
    const Real beta = numerator / squared;
    for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = residual[i] + beta * direction[i];
    return true;
}

inline Real largest_entry(std::span<const Vec4> vectors) {
    Real largest = 0;
    for (const Vec4& v : vectors) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    return largest;
}

template <ContactOperator Op>
SolveResult solve_pcg_pgs(Op& op, const SolveLimits& limits, ConjugateBeta formula = ConjugateBeta::polak_ribiere) {
    BestIterate<Op> best(op);
    op.residual(op.workspace(1));
    std::ranges::copy(op.workspace(1), op.workspace(2).begin());
    // (20), (21) relative to the size of the data; the first phase is asked for less than the second (eps_cg > eps_gs, delta_cg > delta_gs)
    const Real looser = 10 * limits.tolerance;
    const Real residual_start = largest_entry(op.workspace(1));
    const Index phase_limit = conjugate_gradient_limit(op.size(), limits.max_iterations);
    Index iteration = 0, check = 1;
    bool going_on = true;
    while (going_on && iteration < phase_limit) {
        ++iteration;
        Real impulse_change = 0, residual_size = 0;
        going_on = advance_conjugate_gradients(op, formula, impulse_change, residual_size);
        if (limits.fixed_iterations) continue;
        if (impulse_change < looser * largest_entry(op.impulse()) || residual_size < looser * residual_start) going_on = false;
        if (going_on && iteration < check && iteration < phase_limit) continue;
        check = next_check(iteration);
        op.refresh();
        const Real error = op.error();
        if (error <= limits.tolerance) return {iteration, error, true};
        if (std::isfinite(error)) best.offer(error);
    }
    if (limits.fixed_iterations) {
        op.refresh();
    } else {
        best.restore();
    }
    return sweep_until_solved(op, limits, iteration + 1, best);
}

}  // namespace skerry
