// What a solver algorithm sees of a contact problem. Two operators fit: LumpedOperator (lumped masses, carries node velocities) and
// BlockOperator (general 3x3 blocks, problems from files).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <span>

#include "components/types.h"

namespace skerry {

/// u = W r + q with a friction law, and a present impulse r. Errors are relative and mean the same for every algorithm.
template <class Op>
concept ContactOperator = requires(Op op, const Op constant, Index i, Real number, std::span<typename Op::Vector> out,
                                   std::span<const typename Op::Vector> in, typename Op::Vector vector) {
    { constant.size() } -> std::convertible_to<Index>;
    { op.impulse() } -> std::convertible_to<std::span<typename Op::Vector>>;       // writing to it asks for refresh()
    op.refresh();                                                                  // carried state again from the impulse
    { op.step(i, number) } -> std::convertible_to<Real>;                           // one contact; squared size of the change
    { constant.error() } -> std::convertible_to<Real>;                             // of the present impulse
    { constant.suggests_check(number, number) } -> std::convertible_to<bool>;      // change of a sweep, tolerance
    op.residual(out);                                                              // -u, the paper's b - A lambda
    op.multiply(in, out);                                                          // W d
    { constant.project(i, vector) } -> std::convertible_to<typename Op::Vector>;   // friction law
    { constant.feasible(i, vector) } -> std::convertible_to<typename Op::Vector>;  // W(lambda) of (19)
    { op.workspace(i) } -> std::convertible_to<std::span<typename Op::Vector>>;    // slot 0: best iterate; 1..3: the algorithm's
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

/// The next iteration at which the error is measured: 1, 2, 4, 7, 11, 16, ..., then every 16th part more. A measure costs half a sweep.
inline Index next_check(Index iteration) {
    return iteration + 1 + std::min(iteration / 2, 4 + iteration / 16);
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
