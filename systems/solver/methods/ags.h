// Accelerated block Gauss-Seidel method: sweeps, with an extrapolation of the impulses (acceleration.h) after each
// sweep.
#pragma once

#include "systems/solver/methods/acceleration.h"
#include "systems/solver/methods/error_test.h"

namespace skerry {

/// Accelerated sweeps that can be interrupted and continued. The type Test is ErrorTest, or LaneTest for SIMD lanes.
template <SweptOperator Op, class Test = ErrorTest<Op>>
class AcceleratedSweeps {
public:
    using Number = typename Op::Number;

    AcceleratedSweeps(Op& op, Test& test, Real relaxation) : op_(op), test_(test), relaxation_(relaxation) {
        op_.remember();
    }

    /// Continues until the test ends the method, or until `last` iterations have been done in total. The impulse is
    /// then the result of the last sweep. Returns true if the test ended the method.
    bool run_to(Index last) {
        while (iteration_ < last) {
            if (iteration_ > 0) extrapolate();
            ++iteration_;
            change_ = op_.accelerated_sweep(watchdog_.relaxation() * relaxation_);
            if (test_.ends_after_sweep(iteration_, change_.squared_change, last)) return true;
        }
        return false;
    }

    Index iterations() const { return iteration_; }
    /// Resets the extrapolation after other code has changed the impulse.
    void restart() {
        acceleration_ = {};
        op_.remember();
        change_ = unknown();
    }

private:
    static SweepChangeOf<Number> unknown() { return {Number{} + infinity, Number{}}; }

    void extrapolate() {
        // Number of sweeps between two refreshes, which recompute the velocities from the impulses. Extrapolation
        // accumulates rounding errors; a refresh costs half a sweep.
        constexpr Index refresh_interval = 64;
        const LaneMask<Number> plain = watchdog_.plain_after(iteration_, change_.squared_change);
        const Number extrapolation = acceleration_.next(change_, plain);
        if (iteration_ % refresh_interval == 0) op_.refresh_all();
        op_.extrapolate(extrapolation);
    }

    Op& op_;
    Test& test_;
    Real relaxation_;
    Acceleration<Number> acceleration_;
    Watchdog<Number> watchdog_;
    SweepChangeOf<Number> change_ = unknown();
    Index iteration_ = 0;
};

/// Sweeps from the operator's present impulse. The final impulse is the last one if it converged or if the number of
/// sweeps is fixed, otherwise the best one measured.
template <SweptOperator Op>
SolveResult solve_ags(Op& op, const SolveLimits& limits) {
    ErrorTest<Op> test(op, limits);
    AcceleratedSweeps<Op> sweeps(op, test, limits.relaxation);
    return sweeps.run_to(limits.max_iterations) ? test.result() : test.give_up(limits.max_iterations);
}

}  // namespace skerry
