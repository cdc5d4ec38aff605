// Runs the solver method that the settings name.
#pragma once

#include "components/options.h"
#include "systems/solver/methods/ags.h"
#include "systems/solver/methods/any_operator.h"
#include "systems/solver/methods/automatic.h"
#include "systems/solver/methods/pgs.h"

namespace skerry {

/// Runs one of the methods that are compiled once for all operators: newton, pcg_pgs, pcg_fr, pcg_pr.
SolveResult run_cold_method(SolverMethod method, AnyOperator& op, const SolveLimits& limits);

template <ContactOperator Op>
SolveResult run_method(SolverMethod method, Op& op, const SolveLimits& limits) {
    switch (method) {
        case SolverMethod::automatic:
            if constexpr (TakesNewtonSteps<Op>) return solve_automatic(op, limits);
            [[fallthrough]];
        case SolverMethod::ags:
            return solve_ags(op, limits);
        case SolverMethod::pgs:
            return solve_pgs(op, limits);
        default:
            OperatorView<Op> view(op);
            return run_cold_method(method, view, limits);
    }
}

}  // namespace skerry
