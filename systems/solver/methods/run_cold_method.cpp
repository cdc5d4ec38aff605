#include "systems/solver/methods/newton.h"
#include "systems/solver/methods/pcg.h"
#include "systems/solver/methods/run_method.h"

namespace skerry {

SolveResult run_cold_method(SolverMethod method, AnyOperator& op, const SolveLimits& limits) {
    switch (method) {
        case SolverMethod::newton:
            return solve_newton(op, limits);
        case SolverMethod::pcg_pgs:
            return solve_pcg_pgs(op, limits);
        case SolverMethod::pcg_fr:
            return solve_pcg(op, limits, ConjugateBeta::fletcher_reeves);
        case SolverMethod::pcg_pr:
            return solve_pcg(op, limits, ConjugateBeta::polak_ribiere);
        default:
            return {};
    }
}

}  // namespace skerry
