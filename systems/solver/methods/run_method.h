// The one place where the name of a method becomes a call.
#pragma once

#include "components/options.h"
#include "systems/solver/methods/ags.h"
#include "systems/solver/methods/apgd.h"
#include "systems/solver/methods/automatic.h"
#include "systems/solver/methods/mprgp.h"
#include "systems/solver/methods/newton.h"
#include "systems/solver/methods/nncg.h"
#include "systems/solver/methods/pcg.h"
#include "systems/solver/methods/pcg_pgs.h"
#include "systems/solver/methods/pgs.h"

namespace skerry {

template <ContactOperator Op>
SolveResult run_method(SolverMethod method, Op& op, const SolveLimits& limits) {
    switch (method) {
        case SolverMethod::automatic:
            return solve_automatic(op, limits);
        case SolverMethod::newton:
            return solve_newton(op, limits);
        case SolverMethod::pgs:
            return solve_pgs(op, limits);
        case SolverMethod::pcg_pgs:
            return solve_pcg_pgs(op, limits);
        case SolverMethod::pcg_fr:
            return solve_pcg_fr(op, limits);
        case SolverMethod::pcg_pr:
            return solve_pcg_pr(op, limits);
        case SolverMethod::nncg:
            return solve_nncg(op, limits);
        case SolverMethod::apgd:
            return solve_apgd(op, limits);
        case SolverMethod::mprgp:
            return solve_mprgp(op, limits);
        case SolverMethod::ags:
            return solve_ags(op, limits);
    }
    return {};
}

}  // namespace skerry
