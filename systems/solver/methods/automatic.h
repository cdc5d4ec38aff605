// The default method: accelerated sweeps, and Newton steps in regions where sweeps would take longer.
#pragma once

#include <algorithm>
#include <cmath>

#include "systems/solver/methods/ags.h"
#include "systems/solver/methods/newton.h"

namespace skerry {

/// Estimated costs of a sweep and of a Newton step [ns], measured on 4 GHz cores. The ratio of the costs decides when
/// the method changes to Newton steps.
inline Real sweep_cost(Index contacts, Index couplings) {
    constexpr Real contact_cost = 40, coupling_cost = 2;
    return contact_cost * static_cast<Real>(contacts) + coupling_cost * static_cast<Real>(couplings);
}
inline Real newton_step_cost(Index contacts) {
    // Costs of a Newton step: fixed cost, cost per pair of contacts (to fill the equations), and cost per triple of
    // contacts (to factor them) [ns]
    constexpr Real step_cost = 2000, pair_cost = 20, triple_cost = 0.5;
    const Real count = static_cast<Real>(contacts);
    return step_cost + count * count * (pair_cost + triple_cost * count);
}

/// Operators with memory for dense Newton steps and a known number of couplings.
///
/// Operators that have neither this memory nor their own Newton steps use accelerated sweeps only (run_method.h): in
/// the engine, the warm start of the next time step reduces the remaining error at less cost than a factorisation.
template <class Op>
concept KeepsNewtonMemory = requires(Op op, const Op constant) {
    { op.newton_memory() } -> std::same_as<NewtonMemory&>;
    { constant.couplings() } -> std::convertible_to<Index>;  // number of off-diagonal blocks of W
};
/// Operators with their own Newton steps. To estimate the cost of a Newton step [ns], such an operator must inspect the
/// complete region, so the estimate is requested only after the first sweeps.
template <class Op>
concept HasNewtonSteps = requires(Op op, Real number, Index limit) {
    { op.take_newton_steps(number, number, limit) } -> std::same_as<SolveResult>;
    { op.newton_step_cost() } -> std::same_as<Real>;
    { op.sweep_cost() } -> std::same_as<Real>;
    { op.correct_rigid_modes(number, number, limit) } -> std::same_as<SolveResult>;
    { op.corrects_rigid_modes() } -> std::same_as<bool>;
};
template <class Op>
concept TakesNewtonSteps = KeepsNewtonMemory<Op> || HasNewtonSteps<Op>;

/// Number of sweeps that cost as much as two Newton steps (docs/decisions/0004).
template <TakesNewtonSteps Op>
Real newton_trial(Op& op) {
    constexpr Index trial_steps = 2;
    if constexpr (HasNewtonSteps<Op>)
        return trial_steps * op.newton_step_cost() / op.sweep_cost();
    else
        return trial_steps * newton_step_cost(op.size()) / sweep_cost(op.size(), op.couplings());
}

template <TakesNewtonSteps Op>
SolveResult take_newton_steps(Op& op, Real error, Real tolerance, Index limit) {
    if constexpr (HasNewtonSteps<Op>) {
        return op.take_newton_steps(error, tolerance, limit);
    } else {
        OperatorView<Op> view(op);
        return take_newton_steps(view, op.newton_memory(), error, tolerance, limit);
    }
}

/// Alternates a few sweeps with coarse corrections by rigid-body modes, as long as a correction at least halves the
/// error. `steps` grows by the number of Newton steps taken.
template <HasNewtonSteps Op>
SolveResult alternate_with_rigid_modes(Op& op, ErrorTest<Op>& test, AcceleratedSweeps<Op>& sweeps,
                                       const SolveLimits& limits, Index& steps) {
    constexpr Index max_rounds = 8, few = 4;
    constexpr Real gain = 0.5;
    const auto result = [&](const SolveResult& solved) {
        return SolveResult{sweeps.iterations() + steps, solved.error, solved.converged};
    };
    for (Index time = 0; time < max_rounds; ++time) {
        const Index remaining = limits.max_iterations - steps;
        if (sweeps.run_to(std::min(sweeps.iterations() + few, remaining))) break;
        if (sweeps.iterations() >= remaining) break;
        const Real error = test.result().error;
        const SolveResult rounds = op.correct_rigid_modes(error, limits.tolerance, remaining - sweeps.iterations());
        steps += rounds.iterations;
        if (rounds.converged) return result(rounds);
        test.offer(rounds.error);
        sweeps.restart();
        if (rounds.error > gain * error) break;
    }
    return result(test.result());
}

/// Alternates sweeps and Newton steps:
/// 1. Take as many sweeps as cost about two Newton steps, but at least min_sweeps.
/// 2. Repeat if, at their convergence rate, sweeps at the cost of two Newton steps (or the remaining allowed sweeps, if
///    these are fewer) would converge.
/// 3. Otherwise take Newton steps. If they fail, go to 1 with twice as many sweeps.
template <TakesNewtonSteps Op>
SolveResult solve_automatic(Op& op, const SolveLimits& limits) {
    // Newton steps do not support the friction pyramid.
    if (limits.fixed_iterations || op.law() != Friction::cone) return solve_ags(op, limits);
    ErrorTest<Op> test(op, limits);
    AcceleratedSweeps<Op> sweeps(op, test, limits.relaxation);
    constexpr Real min_sweeps = 16;  // least number of sweeps before Newton steps; most regions converge within it
    constexpr bool estimates_late = HasNewtonSteps<Op>;
    Real trial = estimates_late ? 0 : newton_trial(op);
    Real sweep_count = std::max(trial, min_sweeps);
    Real error_before = 1;
    Index iteration_before = 0, newton_steps = 0;
    if constexpr (HasNewtonSteps<Op>)
        if (op.corrects_rigid_modes()) {
            const SolveResult result = alternate_with_rigid_modes(op, test, sweeps, limits, newton_steps);
            if (result.converged || !std::isfinite(result.error)) return result;
        }
    while (true) {
        const Real next = std::min<Real>(sweeps.iterations() + sweep_count, limits.max_iterations - newton_steps);
        bool ended = false;
        // Measure the convergence rate in the later half of the sweeps, because the first sweeps are always fast.
        if (estimates_late && trial > 0) {
            ended = sweeps.run_to((sweeps.iterations() + static_cast<Index>(next)) / 2);
            error_before = test.result().error;
            iteration_before = sweeps.iterations();
        }
        if (!ended) sweeps.run_to(static_cast<Index>(next));
        const SolveResult result = test.result();
        if (result.converged || !std::isfinite(result.error))
            return {result.iterations + newton_steps, result.error, result.converged};
        if (result.iterations + newton_steps >= limits.max_iterations) break;
        if (estimates_late && trial == 0) {
            trial = newton_trial(op);
            // Take Newton steps after at most half of the allowed sweeps. Exception: if two Newton steps cost more than
            // out_of_proportion times all allowed sweeps, only sweeps are done.
            constexpr Real out_of_proportion = 10;
            const Real all = limits.max_iterations;
            sweep_count = trial > out_of_proportion * all ? all : std::min(std::max(trial, min_sweeps), all / 2);
            if (sweep_count > result.iterations) {
                sweep_count -= result.iterations;
                continue;
            }
        }
        const Real rate =
            std::log(error_before / result.error) / static_cast<Real>(result.iterations - iteration_before);
        error_before = result.error;
        iteration_before = result.iterations;
        const Real remaining = limits.max_iterations - result.iterations - newton_steps;
        if (rate * std::min(trial, remaining) > std::log(result.error / limits.tolerance)) continue;
        // Successful solves take up to 14 steps (docs/decisions/0004). An operator's own Newton steps detect failure
        // themselves, so their limit is higher.
        constexpr Index max_steps = HasNewtonSteps<Op> ? 40 : 20;
        const SolveResult newton =
            take_newton_steps(op, result.error, limits.tolerance,
                              std::min(max_steps, limits.max_iterations - result.iterations - newton_steps));
        newton_steps += newton.iterations;
        if (newton.converged) return {result.iterations + newton_steps, newton.error, true};
        test.offer(newton.error);
        sweeps.restart();
        error_before = newton.error;
        sweep_count *= 2;
    }
    return test.give_up(sweeps.iterations() + newton_steps);
}

}  // namespace skerry
