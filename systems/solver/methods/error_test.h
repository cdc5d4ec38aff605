// Decides when a method measures its error and when it ends, and keeps the best impulse.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

struct SolveLimits {
    Real tolerance = 1e-3;
    Index max_iterations = 200;
    bool fixed_iterations = false;  // no error tests, exactly max_iterations
    Real relaxation = 1;
};

/// A warm start with a larger error is compared with zero impulses, whose error is about 1.
inline constexpr Real suspicious_start = 0.5;

/// Next iteration at which the error is measured: 1, 2, 4, 7, 11, 17, ..., later at intervals of an eighth. A
/// measurement costs half a sweep. A solution is noticed late by at most an eighth of its iterations plus five.
inline Index next_check(Index iteration) {
    constexpr Index first = 2, later = 8, offset = 4;  // fractions of the iterations done; offset of the second rule
    return iteration + 1 + std::min(iteration / first, offset + iteration / later);
}

/// Stores the best impulse: in slot 0 of the workspace unless the operator has its own place for it.
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

/// The best impulse at the measurements, by error (docs/methods/errors.md 5.3).
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
    /// Offers the present impulse, not measured before. An error that is not finite is ignored.
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

/// Convergence test shared by all methods. With a fixed count it measures nothing during sweeps.
template <SweptOperator Op>
class ErrorTest {
public:
    ErrorTest(Op& op, const SolveLimits& limits) : op_(op), limits_(limits), best_(op) {}

    /// True if the error is due to be measured after this iteration.
    bool due(Index iteration) const { return iteration >= check_; }
    /// Schedules the next measurement at this iteration.
    void expect(Index iteration) { check_ = iteration; }

    /// Measures the error of the present impulse. Returns true if the method must end: the error is not finite, or
    /// within the tolerance and the count is not fixed.
    bool ends(Index iteration) {
        iteration_ = iteration;
        error_ = op_.error();
        if (!std::isfinite(error_)) return true;
        if (error_ <= limits_.tolerance && !limits_.fixed_iterations) return true;
        best_.offer(error_);
        if (due(iteration)) check_ = next_check(iteration);
        return false;
    }
    /// Variant after a sweep with this change. Measures only if due, if the change suggests it, or after the last
    /// sweep.
    bool ends_after_sweep(Index iteration, Real change, Index last) {
        if (limits_.fixed_iterations) return false;
        const bool suggested = op_.suggests_check(change, limits_.tolerance);  // call it exactly once per sweep
        return (suggested || due(iteration) || iteration >= last) && ends(iteration);
    }

    /// Restores the best impulse.
    void go_back() { best_.restore(); }
    /// Offers the present impulse, found by another method.
    void offer(Real error) { best_.offer(error); }
    /// Result of the last measurement.
    SolveResult result() const { return {iteration_, error_, error_ <= limits_.tolerance}; }
    /// Ends without convergence: restores the best impulse, or keeps the last one if none was measured.
    SolveResult give_up(Index iterations) {
        if (limits_.fixed_iterations && best_.known()) best_.offer_last(op_.error());
        const Real error = best_.restore();
        return {iterations, error, error <= limits_.tolerance};
    }

private:
    Op& op_;
    const SolveLimits& limits_;
    BestIterate<Op> best_;
    Real error_ = std::numeric_limits<Real>::infinity();
    Index iteration_ = 0, check_ = 1;
};

}  // namespace skerry
