// Accelerated projected gradients (Nesterov; Mazhar et al. 2015; docs/methods/region_solver.md 5.2). All contacts step
// at once. An iteration is one product with W whatever the couplings are, and nothing depends on the order of the
// contacts.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "profiling/lab/power_iteration.h"
#include "systems/solver/methods/error_test.h"

namespace skerry::lab {

/// Projects with the friction law of the operator. With `cone` the fixed point is the exact Coulomb solution for any
/// step length, but there is no theorem of convergence. In measurements it beats De Saxce's shifted velocity with the
/// projection onto the cone (docs/solvers.md). With the associated law (associated_operator.h) the method is the convex
/// one of the literature and converges. An iteration is one product with W, whether its step is accepted or rejected.
/// Leaves the last impulse if it converged or the iteration count is fixed, else the best one.
template <ContactOperator Op>
class AcceleratedGradients {
public:
    AcceleratedGradients(Op& op, const SolveLimits& limits) : op_(op), limits_(limits), test_(op, limits) {}

    SolveResult run() {
        if (!limits_.fixed_iterations && test_.ends(0)) return test_.result();
        start();
        for (Index iteration = 1; iteration <= limits_.max_iterations; ++iteration) {
            const bool taken = try_step();
            const bool due = iteration == limits_.max_iterations || (taken && test_.due(iteration));
            if (!limits_.fixed_iterations && due && test_.ends(iteration)) return test_.result();
            if (taken) extrapolate();
        }
        return test_.give_up(limits_.max_iterations);
    }

private:
    void start() {
        constexpr Index power_steps = 10;  // number of products; backtracking corrects an estimate that is too low
        steepness_ = largest_eigenvalue(op_, power_steps, [](Index, const Vec4& v) { return v; });
        std::ranges::copy(op_.impulse(), start_.begin());
        std::ranges::copy(start_, previous_.begin());
        op_.residual(pull_);
        std::ranges::copy(pull_, pull_previous_.begin());
    }

    /// Steps from the extrapolated impulse and writes the result to the operator. Returns false if the step was longer
    /// than the curvature along it allows.
    bool try_step() {
        const std::span<Vec4> impulse = op_.impulse();
        for (Index i = 0; i < op_.size(); ++i) {
            const Real mobility = op_.mobility(i);
            impulse[i] =
                mobility > 0 ? op_.project(i, start_[i] + pull_[i] / (steepness_ * mobility)) : Vec4(Vec4::Zero());
        }
        op_.refresh();
        op_.residual(pull_next_);
        Real curvature = 0, size = 0;
        against_ = 0;
        for (Index i = 0; i < op_.size(); ++i) {
            const Vec4 change = impulse[i] - start_[i];
            curvature += change.dot(pull_[i] - pull_next_[i]);
            size += op_.mobility(i) * change.squaredNorm();
            against_ -= op_.mobility(i) * change.dot(impulse[i] - previous_[i]);
        }
        if (!(curvature > steepness_ * size)) return true;
        steepness_ = std::max(beyond_curvature * curvature / size, steeper * steepness_);
        return false;
    }

    /// Extrapolates impulses and residuals. Residuals are affine in the impulses and need no product of their own. A
    /// step that turns back resets the momentum.
    void extrapolate() {
        const Real next_momentum = (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2;
        Real beyond = (momentum_ - 1) / next_momentum;
        momentum_ = next_momentum;
        if (against_ > 0) {
            momentum_ = 1;
            beyond = 0;
        }
        const std::span<Vec4> impulse = op_.impulse();
        for (std::size_t i = 0; i < impulse.size(); ++i) {
            start_[i] = impulse[i] + beyond * (impulse[i] - previous_[i]);
            pull_[i] = pull_next_[i] + beyond * (pull_next_[i] - pull_previous_[i]);
            previous_[i] = impulse[i];
        }
        std::swap(pull_previous_, pull_next_);
        steepness_ *= forgotten;  // the curvature along the path is often below the bound of the whole space
    }

    // Growth of the steepness after a step that was too long: at least `steeper`, and to `beyond_curvature` times the
    // measured curvature. The paper doubles it, and reduces it by a tenth per step. Smaller factors reject fewer
    // steps.
    static constexpr Real beyond_curvature = 1.05, steeper = 1.2;
    static constexpr Real forgotten = 0.97;  // factor of the steepness after each accepted step

    Op& op_;
    const SolveLimits& limits_;
    ErrorTest<Op> test_;
    Real steepness_ = 1;  // L: present estimate of the largest eigenvalue of D^-1 W
    Real momentum_ = 1, against_ = 0;
    std::span<Vec4> previous_ = op_.workspace(1), start_ = op_.workspace(3);
    // storage of two vectors beyond the workspace of the operator
    std::vector<Vec4> own_ = std::vector<Vec4>(2 * op_.impulse().size());
    // -u (u: contact velocity) at the extrapolated, the previous and the present impulse
    std::span<Vec4> pull_ = std::span(own_).first(op_.impulse().size()), pull_previous_ = op_.workspace(2),
                    pull_next_ = std::span(own_).subspan(op_.impulse().size());
};

template <ContactOperator Op>
SolveResult solve_apgd(Op& op, const SolveLimits& limits) {
    return AcceleratedGradients<Op>(op, limits).run();
}

}  // namespace skerry::lab
