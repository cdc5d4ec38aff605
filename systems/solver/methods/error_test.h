// Decides when a method measures its error and when the method ends. Stores the best impulse.
#pragma once

#include <algorithm>
#include <cmath>

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

struct SolveLimits {
    Real tolerance = 1e-3;
    Index max_iterations = 200;
    bool fixed_iterations = false;  // true: do exactly max_iterations without error tests
    Real relaxation = 1;
};

/// A warm start with a relative error above this value is compared with zero impulses, whose relative error is about 1.
inline constexpr Real suspicious_start = 0.5;

/// Next iteration at which the error is measured: 1, 2, 4, 7, 11, 17, ...; later the iteration number grows by an
/// eighth. A measurement costs half a sweep. Convergence is detected late by at most an eighth of the iterations plus
/// five.
inline Index next_check(Index iteration) {
    // The interval between measurements is half of the number of iterations so far; later it is an eighth of this
    // number plus an offset.
    constexpr Index first = 2, later = 8, offset = 4;
    return iteration + 1 + std::min(iteration / first, offset + iteration / later);
}

/// Stores the present impulse as the best one: in slot 0 of the workspace, or by op.keep() if the operator has its own
/// storage.
template <SweptOperator Op>
void keep_impulse(Op& op) {
    if constexpr (ContactOperator<Op>) {
        std::ranges::copy(op.impulse(), op.workspace(0).begin());
    } else {
        op.keep();
    }
}
template <SweptOperator Op>
void restore_impulse(Op& op) {
    if constexpr (ContactOperator<Op>) {
        std::ranges::copy(op.workspace(0), op.impulse().begin());
        op.refresh();
    } else {
        op.restore();
    }
}

/// The impulse with the smallest error among the measured ones (docs/methods/errors.md 5.3).
template <SweptOperator Op>
class BestIterate {
public:
    explicit BestIterate(Op& op) : op_(op) {}

    void offer(Real error) {
        if (known_ && !(error < error_)) return;
        known_ = true;
        error_ = error;
        keep_impulse(op_);
    }

    bool known() const { return known_; }
    /// Variant of offer() that ignores an error that is not finite. It serves the last impulse of a method with a fixed
    /// number of iterations: its error has not been tested before, and may be infinite or NaN.
    void offer_last(Real error) {
        if (std::isfinite(error)) offer(error);
    }

    /// Restores the best impulse and returns its error.
    Real restore() {
        if (!known_) return op_.error();
        restore_impulse(op_);
        return error_;
    }

private:
    Op& op_;
    bool known_ = false;
    Real error_ = 0;
};

/// Convergence test shared by all methods. If the number of iterations is fixed, the error is not measured after
/// sweeps.
template <SweptOperator Op>
class ErrorTest {
public:
    ErrorTest(Op& op, const SolveLimits& limits) : op_(op), limits_(limits), best_(op) {}

    /// True if the error must be measured after this iteration.
    bool due(Index iteration) const { return iteration >= check_; }
    /// Schedules the next measurement at this iteration.
    void expect(Index iteration) { check_ = iteration; }

    /// Measures the error of the present impulse. Returns true if the method must end: either the error is not finite,
    /// or it is within the tolerance and the number of iterations is not fixed.
    bool ends(Index iteration) {
        iteration_ = iteration;
        error_ = op_.error();
        if (!std::isfinite(error_)) return true;
        if (error_ <= limits_.tolerance && !limits_.fixed_iterations) return true;
        best_.offer(error_);
        if (due(iteration)) check_ = next_check(iteration);
        return false;
    }
    /// Variant of ends() for a sweep with the squared impulse change `change`. It measures the error only if a
    /// measurement is due, if the change suggests convergence, or after the last sweep.
    bool ends_after_sweep(Index iteration, Real change, Index last) {
        if (limits_.fixed_iterations) return false;
        // The operator may collect sums during a sweep, and suggests_check() resets them. So it must be called exactly
        // once per sweep.
        const bool suggested = op_.suggests_check(change, limits_.tolerance);
        return (suggested || due(iteration) || iteration >= last) && ends(iteration);
    }

    /// Restores the best impulse, which is the measured impulse with the smallest error.
    void restore_best() { best_.restore(); }
    /// Stores the present impulse, found by another method, if its error is the smallest so far.
    void offer(Real error) { best_.offer(error); }
    /// Result of the last error measurement.
    SolveResult result() const { return {iteration_, error_, error_ <= limits_.tolerance}; }
    /// Ends the method without convergence. Restores the best impulse, or keeps the last one if no error was measured.
    SolveResult give_up(Index iterations) {
        if (limits_.fixed_iterations && best_.known()) best_.offer_last(op_.error());
        const Real error = best_.restore();
        return {iterations, error, error <= limits_.tolerance};
    }

private:
    Op& op_;
    const SolveLimits& limits_;
    BestIterate<Op> best_;
    Real error_ = infinity;
    Index iteration_ = 0, check_ = 1;
};

}  // namespace skerry
