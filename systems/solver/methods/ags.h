// Accelerated block Gauss-Seidel (methods.md 2.4): Nesterov extrapolation of the sweeps, with a restart when the step turns against the
// motion, a guard on the residual, and a watchdog that goes back to plain sweeps when nothing is gained.
#pragma once

#include <limits>

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

/// When to trust the acceleration. Sizes are those of a sweep's change, squared.
class Watchdog {
public:
    /// Whether this sweep is a plain one, and with which relaxation the next is done.
    bool plain() const { return plain_left_ > 0; }
    Real relaxation() const { return relaxation_; }

    void observe(Index iteration, Real change) {
        if (change < 0.7 * best_) {
            best_ = change;
            best_at_ = iteration;
        }
        if (plain_left_ > 0) {
            if (--plain_left_ > 0) return;
            relaxation_ = 1;
            best_ = change;
            best_at_ = iteration;
        } else if (iteration - best_at_ > std::max<Index>(60, (iteration - last_phase_) / 2)) {
            ++phase_;
            last_phase_ = best_at_ = iteration;
            plain_left_ = std::min<Index>(Index(200) << std::min<Index>(phase_, 7), 20000);
            relaxation_ = phase_ % 2 == 0 ? 0.8 : 1;  // every second time under-relaxed
            best_ = std::numeric_limits<Real>::infinity();
        }
    }

private:
    Real best_ = std::numeric_limits<Real>::infinity();
    Index best_at_ = 0, last_phase_ = 0, phase_ = 0, plain_left_ = 0;
    Real relaxation_ = 1;
};

/// Sweeps from the operator's present impulse. Leaves the last impulse when it converged or the count is fixed, else the best one seen.
template <ContactOperator Op>
SolveResult solve_ags(Op& op, const SolveLimits& limits) {
    constexpr Real guard = 2;               // 10 is 15 % faster on easy problems and fails on jammed ones
    constexpr Index refresh_interval = 64;  // extrapolation adds up rounding
    constexpr Real infinite = std::numeric_limits<Real>::infinity();
    BestIterate<Op> best(op);
    Watchdog watchdog;
    Real momentum = 1, smallest_change = infinite;
    Index check = 1;
    op.remember();
    for (Index iteration = 1; iteration <= limits.max_iterations; ++iteration) {
        const auto [change, against] = op.accelerated_sweep(watchdog.relaxation() * limits.relaxation);
        const bool due = iteration >= check || iteration == limits.max_iterations || op.suggests_check(change, limits.tolerance);
        if (due && !limits.fixed_iterations) {
            const Real error = op.error();
            if (error <= limits.tolerance) return {iteration, error, true};
            if (!std::isfinite(error)) return {iteration, error, false};
            best.offer(error);
            if (iteration >= check) check = next_check(iteration);
        }
        if (iteration == limits.max_iterations) break;

        const Real next_momentum = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
        Real extrapolation = (momentum - 1) / next_momentum;
        momentum = next_momentum;
        smallest_change = std::min(smallest_change, change);
        const bool was_plain = watchdog.plain();
        watchdog.observe(iteration, change);
        if (was_plain || watchdog.plain() || against > 0 || change > guard * smallest_change) {
            momentum = 1;
            extrapolation = 0;
            smallest_change = change;
        }
        if (iteration % refresh_interval == 0) op.refresh_all();
        op.extrapolate(extrapolation);
    }
    if (!limits.fixed_iterations) return {limits.max_iterations, best.restore(), false};
    const Real error = op.error();
    return {limits.max_iterations, error, error <= limits.tolerance};
}

}  // namespace skerry
