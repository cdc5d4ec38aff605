// What a solver algorithm sees of a contact problem. Two operators fit: LumpedOperator (lumped masses, carries node velocities) and
// BlockOperator (general 3x3 blocks, problems from files).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <span>

#include "components/types.h"
#include "systems/solver/operators/friction_law.h"

namespace skerry {

/// Vectors by contact that an algorithm may ask for.
inline constexpr std::size_t workspace_limit = 6;

/// What a sweep did.
struct SweepChange {
    Real size;     // sum of change . W_ii change
    Real against;  // -sum of change . W_ii (impulse - previous): positive when the sweep turns back
};

/// u = W r + q with a friction law, and a present impulse r. Errors are relative and mean the same for every algorithm. W_ii is the diagonal
/// block of contact i.
template <class Op>
concept ContactOperator = requires(Op op, const Op constant, Index i, Real number, std::span<Vec4> out, std::span<const Vec4> in,
                                   const Vec4& vector, Eigen::MatrixXd matrix) {
    { constant.size() } -> std::convertible_to<Index>;
    { op.impulse() } -> std::convertible_to<std::span<Vec4>>;     // writing to it asks for refresh()
    op.refresh();                                                 // carried state again from the impulse
    { op.workspace(i) } -> std::convertible_to<std::span<Vec4>>;  // slot 0: best iterate; the rest: the algorithm's
    { op.sweep(number) } -> std::convertible_to<Real>;            // each contact exactly in its turn, relaxed; sum of change . W_ii change
    { op.accelerated_sweep(number) } -> std::same_as<SweepChange>;       // the same, compared with the previous
    { constant.inner(i, vector, vector) } -> std::convertible_to<Real>;  // a . W_ii b
    { op.error() } -> std::convertible_to<Real>;                         // of the present impulse
    { op.suggests_check(number, number) } -> std::convertible_to<bool>;  // after each sweep: its change, tolerance
    op.remember();                                                       // previous (slot 1) = present
    op.extrapolate(number);                                              // present += number (present - previous), previous = present
    op.refresh_all();                                                    // refresh() for both
    op.residual(out);                                                    // -u, the paper's b - A lambda
    op.multiply(in, out);                                                // W d
    { constant.project(i, vector) } -> std::convertible_to<Vec4>;        // friction law
    { constant.feasible(i, vector) } -> std::convertible_to<Vec4>;       // W(lambda) of (19)
    { constant.normal(i) } -> std::convertible_to<Vec4>;                 // unit
    { constant.limits(i) } -> std::convertible_to<FrictionLimits>;
    { constant.mobility(i) } -> std::convertible_to<Real>;  // s/kg, a number for W_ii: a third of its trace; 0: moves nothing
    { constant.law() } -> std::same_as<Friction>;
    constant.assemble(matrix);  // W, dense, 3 size() rows
};

struct SolveLimits {
    Real tolerance = 1e-3;
    Index max_iterations = 200;
    bool fixed_iterations = false;  // no tests, exactly max_iterations
    Real relaxation = 1;
};

struct SolveResult {
    Index iterations = 0;
    Real error = 0;
    bool converged = false;
};

/// Both kinds of sweep, over the contacts in their order. Step: what one contact does, and change . W_ii change of it.
template <class Op, class Step>
Real sweep_in_order(Op& op, const Step& step) {
    Real change = 0;
    for (Index i = 0; i < op.size(); ++i) change += step(i);
    return change;
}

template <class Op, class Step>
SweepChange accelerated_sweep_in_order(Op& op, const Step& step) {
    const std::span<const Vec4> impulse = op.impulse(), previous = op.workspace(1);
    SweepChange sum{0, 0};
    for (Index i = 0; i < op.size(); ++i) {
        const Vec4 before = impulse[i];
        const Real size = step(i);
        if (size == 0) continue;
        sum.size += size;
        sum.against -= op.inner(i, impulse[i] - before, impulse[i] - previous[i]);
    }
    return sum;
}

/// The next iteration at which the error is measured: 1, 2, 4, 7, 11, 16, ..., then every 8th part more. A measure costs half a sweep.
inline Index next_check(Index iteration) {
    return iteration + 1 + std::min(iteration / 2, 4 + iteration / 8);
}

/// The best impulse seen at the checks, by error (methods.md 1.3 h).
template <ContactOperator Op>
class BestIterate {
public:
    explicit BestIterate(Op& op) : op_(op) {}

    void offer(Real error) {
        if (known_ && !(error < error_)) return;
        known_ = true;
        error_ = error;
        std::ranges::copy(op_.impulse(), op_.workspace(0).begin());
    }

    /// Puts the best impulse back and returns its error.
    Real restore() {
        if (!known_) return op_.error();
        std::ranges::copy(op_.workspace(0), op_.impulse().begin());
        op_.refresh();
        return error_;
    }

private:
    Op& op_;
    bool known_ = false;
    Real error_ = 0;
};

}  // namespace skerry
