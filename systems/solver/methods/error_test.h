// When a method measures its error, what it keeps on the way, and when it ends.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/solver/operators/contact_operator.h"

namespace skerry {

struct SolveLimits {
    Real tolerance = 1e-3;
    Index max_iterations = 200;
    bool fixed_iterations = false;  // no tests, exactly max_iterations
    Real relaxation = 1;
};

/// Error of a start that is compared with zero, which has one of about 1.
inline constexpr Real suspicious_start = 0.5;

/// The next iteration at which the error is measured: 1, 2, 4, 7, 11, 17, ..., then every 8th part more. A measure
/// costs half a sweep; a solution is noticed at most an eighth of its iterations, and five, late.
inline Index next_check(Index iteration) {
    constexpr Index first = 2, later = 8, offset = 4;  // shares of the iterations done, and where the second begins
    return iteration + 1 + std::min(iteration / first, offset + iteration / later);
}

/// Where operators have no place of their own for the best impulse it is in slot 0 of the workspace.
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

/// The best impulse seen at the checks, by error (docs/methods/errors.md 5.3).
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
    /// The present impulse, not measured before; an error that is not finite is none of the best.
    void offer_last(Real error) {
        if (std::isfinite(error)) offer(error);
    }

    /// Puts the best impulse back and returns its error.
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

/// The test that all methods share. With a fixed count sweeps measure nothing before the end.
template <SweptOperator Op>
class ErrorTest {
public:
    ErrorTest(Op& op, const SolveLimits& limits) : op_(op), limits_(limits), best_(op) {}

    /// Whether the error is to be measured after this iteration.
    bool due(Index iteration) const { return iteration >= check_; }
    /// Makes it due at this iteration.
    void expect(Index iteration) { check_ = iteration; }

    /// Measures the present impulse. True when it ends the method: not finite, or within the tolerance where the count
    /// is not fixed.
    bool ends(Index iteration) {
        iteration_ = iteration;
        error_ = op_.error();
        if (!std::isfinite(error_)) return true;
        if (error_ <= limits_.tolerance && !limits_.fixed_iterations) return true;
        best_.offer(error_);
        if (due(iteration)) check_ = next_check(iteration);
        return false;
    }
    /// The same after a sweep with this change, where it is due, is suggested by the change, or was the last one.
    bool ends_after_sweep(Index iteration, Real change, Index last) {
        if (limits_.fixed_iterations) return false;
        const bool suggested = op_.suggests_check(change, limits_.tolerance);  // once a sweep
        return (suggested || due(iteration) || iteration >= last) && ends(iteration);
    }

    /// Leaves the best impulse seen.
    void go_back() { best_.restore(); }
    /// The present impulse, that another method found.
    void offer(Real error) { best_.offer(error); }
    /// Of the last measure.
    SolveResult result() const { return {iteration_, error_, error_ <= limits_.tolerance}; }
    /// When the iterations are used up: leaves the best impulse seen, the last one where none was measured.
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
