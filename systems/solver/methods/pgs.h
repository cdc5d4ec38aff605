// Block projected Gauss-Seidel method: equations (14), (15) of Lazarevych et al. (2010). It solves the contacts
// exactly, one after the other.
#pragma once

#include "systems/solver/methods/error_test.h"

namespace skerry {

/// Does sweeps number `first` .. max_iterations over the contacts in order, from the operator's present impulse. The
/// final impulse is the last one if it converged or if the number of sweeps is fixed, otherwise the best one.
template <ContactOperator Op>
SolveResult sweep_until_solved(Op& op, const SolveLimits& limits, Index first, ErrorTest<Op>& test) {
    test.expect(first);
    for (Index iteration = first; iteration <= limits.max_iterations; ++iteration)
        if (test.ends_after_sweep(iteration, op.sweep(limits.relaxation), limits.max_iterations)) return test.result();
    return test.give_up(limits.max_iterations);
}

template <ContactOperator Op>
SolveResult solve_pgs(Op& op, const SolveLimits& limits) {
    ErrorTest<Op> test(op, limits);
    return sweep_until_solved(op, limits, 1, test);
}

}  // namespace skerry
