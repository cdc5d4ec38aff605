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

/// Accelerated sweeps that can stop and go on where they were.
template <ContactOperator Op>
class AcceleratedSweeps {
public:
    explicit AcceleratedSweeps(Op& op) : best_(op), op_(op) { op_.remember(); }

    /// Goes on until the error is within the tolerance or `last` iterations have been done in all. `error` is that of the last measure;
    /// unless converged, the impulse is that of the last sweep.
    SolveResult run_to(Index last, const SolveLimits& limits) {
        while (iteration_ < last) {
            if (iteration_ > 0) extrapolate();
            ++iteration_;
            change_ = op_.accelerated_sweep(watchdog_.relaxation() * limits.relaxation);
            if (limits.fixed_iterations) continue;
            const bool suggested = op_.suggests_check(change_.size, limits.tolerance);  // once a sweep
            if (!suggested && iteration_ < check_ && iteration_ < last) continue;
            error_ = op_.error();
            if (error_ <= limits.tolerance) return {iteration_, error_, true};
            if (!std::isfinite(error_)) return {iteration_, error_, false};
            best_.offer(error_);
            if (iteration_ >= check_) check_ = next_check(iteration_);
        }
        if (limits.fixed_iterations) error_ = op_.error();
        return {iteration_, error_, error_ <= limits.tolerance};
    }

    Index iterations() const { return iteration_; }
    /// Forgets the momentum: the impulse has been changed from outside.
    void start_anew() {
        momentum_ = 1;
        smallest_change_ = infinite;
        op_.remember();
        change_ = {infinite, 0};
    }
    /// Puts the best impulse back.
    SolveResult give_up() { return {iteration_, best_.restore(), false}; }

private:
    static constexpr Real infinite = std::numeric_limits<Real>::infinity();

    void extrapolate() {
        constexpr Real guard = 2;               // 10 is 15 % faster on easy problems and fails on jammed ones
        constexpr Index refresh_interval = 64;  // extrapolation adds up rounding
        const Real next_momentum = (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2;
        Real extrapolation = (momentum_ - 1) / next_momentum;
        momentum_ = next_momentum;
        smallest_change_ = std::min(smallest_change_, change_.size);
        const bool was_plain = watchdog_.plain();
        watchdog_.observe(iteration_, change_.size);
        if (was_plain || watchdog_.plain() || change_.against > 0 || change_.size > guard * smallest_change_) {
            momentum_ = 1;
            extrapolation = 0;
            smallest_change_ = change_.size;
        }
        if (iteration_ % refresh_interval == 0) op_.refresh_all();
        op_.extrapolate(extrapolation);
    }

    BestIterate<Op> best_;
    Op& op_;
    Watchdog watchdog_;
    Real momentum_ = 1, smallest_change_ = infinite, error_ = infinite;
    SweepChange change_{infinite, 0};
    Index iteration_ = 0, check_ = 1;
};

/// Sweeps from the operator's present impulse. Leaves the last impulse when it converged or the count is fixed, else the best one seen.
template <ContactOperator Op>
SolveResult solve_ags(Op& op, const SolveLimits& limits) {
    AcceleratedSweeps<Op> sweeps(op);
    const SolveResult result = sweeps.run_to(limits.max_iterations, limits);
    if (result.converged || limits.fixed_iterations || !std::isfinite(result.error)) return result;
    return sweeps.give_up();
}

}  // namespace skerry
