// What a method sees of a contact problem: the Delassus operator W = J M^-1 J^T, never formed where it need not be,
// with the law of friction of each contact. J takes velocities of nodes to those of contacts, M is the lumped mass.
// LumpedOperator (node velocities carried along; a step of the engine) and BlockOperator (blocks of W, problems from
// files) fit. NormalRows knows accelerated sweeps alone.
#pragma once

#include <concepts>
#include <span>

#include "components/types.h"
#include "systems/solver/local/friction_law.h"

namespace skerry {

/// Vectors by contact that a method may ask for.
inline constexpr std::size_t workspace_limit = 4;

/// What a method came to.
struct SolveResult {
    Index iterations = 0;
    Real error = 0;
    bool converged = false;
};

/// What a sweep did. T: Real, or Real8 for eight regions side by side.
template <class T>
struct SweepChangeOf {
    T size{};     // sum of change . W_ii change
    T against{};  // -sum of change . W_ii (impulse - previous): positive when the sweep turns back

    SweepChangeOf& operator+=(const SweepChangeOf& other) {
        size += other.size;
        against += other.against;
        return *this;
    }
};
using SweepChange = SweepChangeOf<Real>;

/// Impulses that accelerated sweeps improve. Number: what an error is, Real or Real8. W_ii is the diagonal block of
/// contact i.
template <class Op>
concept SweptOperator = requires(Op& op, Real relaxation, typename Op::Number number) {
    // each contact exactly in its turn, relaxed
    { op.accelerated_sweep(relaxation) } -> std::same_as<SweepChangeOf<typename Op::Number>>;
    { op.error() } -> std::same_as<typename Op::Number>;  // of the present impulse
    op.suggests_check(number, relaxation);                // after each sweep: its change, tolerance
    op.remember();                                        // previous = present
    // present += number (present - previous), previous = present
    op.extrapolate(number);
    op.refresh_all();  // what is carried along with present and previous, again from them
};

/// u = W r + q with a friction law, and a present impulse r. Errors are relative and mean the same for every method.
template <class Op>
concept ContactOperator = SweptOperator<Op> &&
    requires(Op& op, const Op& constant, Index i, Real number, std::span<Vec4> out, std::span<const Vec4> in,
             const Vec4& vector, Eigen::MatrixXd matrix) {
    { constant.size() } -> std::convertible_to<Index>;
    { op.impulse() } -> std::convertible_to<std::span<Vec4>>;  // writing to it asks for refresh()
    op.refresh();                                              // carried state again from the impulse
    // slot 0: best iterate; 1: previous, of accelerated sweeps; the rest: the method's
    { op.workspace(i) } -> std::convertible_to<std::span<Vec4>>;
    { op.sweep(number) } -> std::convertible_to<Real>;              // as accelerated_sweep, looking at the size alone
    op.residual(out);                                               // -u, the paper's b - A lambda
    op.multiply(in, out);                                           // W d
    { constant.project(i, vector) } -> std::convertible_to<Vec4>;   // friction law
    { constant.feasible(i, vector) } -> std::convertible_to<Vec4>;  // W(lambda) of (19)
    { constant.normal(i) } -> std::convertible_to<Vec4>;            // unit
    { constant.limits(i) } -> std::convertible_to<FrictionLimits>;
    // s/kg, a number for W_ii: a third of its trace; 0: moves nothing
    { constant.mobility(i) } -> std::convertible_to<Real>;
    { constant.law() } -> std::same_as<Friction>;
    constant.assemble(matrix);  // W, dense, 3 size() rows
};

/// present += factor (present - previous), previous = present.
template <class V>
inline void extrapolate_one(Real factor, V& present, V& previous) {
    const V now = present;
    present = now + factor * (now - previous);
    previous = now;
}
template <class V>
inline void extrapolate_range(std::size_t begin, std::size_t end, Real factor, std::span<V> present,
                              std::span<V> previous) {
    for (std::size_t i = begin; i < end; ++i) extrapolate_one(factor, present[i], previous[i]);
}

}  // namespace skerry
