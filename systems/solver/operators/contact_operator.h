// Interface between solver methods and contact problems: the Delassus operator W = J M^-1 J^T, formed only where
// necessary, and the friction law of each contact. J maps velocities of nodes and bodies to contact velocities; M is
// the mass matrix. Operators:
// - LumpedOperator: stores node velocities; used in a step of the engine
// - BodyOperator: regions with rigid bodies
// - BlockOperator: explicit blocks of W; problems from files
// - NormalRows: contacts without friction; supports accelerated sweeps only
#pragma once

#include <concepts>
#include <span>

#include "components/types.h"
#include "systems/solver/local/friction_law.h"

namespace skerry {

/// Largest number of workspace vectors that a method may use. Each has one entry per contact.
inline constexpr std::size_t workspace_limit = 4;

/// Result of a solver method.
struct SolveResult {
    Index iterations = 0;
    Real error = 0;
    bool converged = false;
};

/// Change of the impulses in one sweep. W_ii is the diagonal block of contact i. T is Real, or Real8 for eight regions
/// in SIMD lanes.
template <class T>
struct SweepChangeOf {
    T squared_change{};  // sum of change . W_ii change over the contacts
    // Minus the sum of change . W_ii (impulse - previous); positive if the sweep reverses the previous change of the
    // impulses.
    T reversal{};

    SweepChangeOf& operator+=(const SweepChangeOf& other) {
        squared_change += other.squared_change;
        reversal += other.reversal;
        return *this;
    }
};
using SweepChange = SweepChangeOf<Real>;

/// Contact problem that accelerated sweeps (ags.h) can solve. Number is the numeric type of op.error(): Real, or Real8
/// for eight regions in SIMD lanes.
template <class Op>
concept SweptOperator = requires(Op& op, Real relaxation, typename Op::Number number) {
    // One sweep with this relaxation factor: solves the contacts exactly, one after the other.
    { op.accelerated_sweep(relaxation) } -> std::same_as<SweepChangeOf<typename Op::Number>>;
    { op.error() } -> std::same_as<typename Op::Number>;  // error of the present impulse
    // Call once per sweep, with the squared change of the impulses by the sweep, and the tolerance. True if the error
    // may be within the tolerance.
    op.suggests_check(number, relaxation);
    op.remember();  // stores the present impulses and velocities as the previous ones
    // Extrapolates the impulses and velocities: present += number (present - previous), with the old present values
    // stored as the previous ones.
    op.extrapolate(number);
    op.refresh_all();  // recomputes the stored velocities of present and previous impulses
};

/// Contact problem u = W r + q with a friction law and a present impulse r. Errors are relative and comparable between
/// methods.
template <class Op>
concept ContactOperator = SweptOperator<Op> &&
    requires(Op& op, const Op& constant, Index i, Real number, std::span<Vec4> out, std::span<const Vec4> in,
             const Vec4& vector, Eigen::MatrixXd matrix) {
    { constant.size() } -> std::convertible_to<Index>;
    { op.impulse() } -> std::convertible_to<std::span<Vec4>>;  // call refresh() after writing to this span
    op.refresh();                                              // recomputes the stored velocities from the impulse
    // Slot 0: best iterate; slot 1: previous impulse of accelerated sweeps; other slots: free for the method.
    { op.workspace(i) } -> std::convertible_to<std::span<Vec4>>;
    { op.sweep(number) } -> std::convertible_to<Real>;  // one sweep; returns SweepChangeOf::squared_change
    op.residual(out);      // writes -u of each contact; Lazarevych et al. (2010) call it b - A lambda
    op.multiply(in, out);  // out = W in
    { constant.project(i, vector) } -> std::convertible_to<Vec4>;  // projection of an impulse onto the friction law
    {
        constant.feasible(i, vector)
        } -> std::convertible_to<Vec4>;                   // W(lambda) in equation (19) of Lazarevych et al. (2010)
    { constant.normal(i) } -> std::convertible_to<Vec4>;  // unit vector
    { constant.limits(i) } -> std::convertible_to<FrictionLimits>;
    // Scalar substitute for W_ii: a third of the trace of W_ii; 0 if the contact can move nothing [1/kg]
    { constant.mobility(i) } -> std::convertible_to<Real>;
    { constant.law() } -> std::same_as<Friction>;
    constant.assemble(matrix);  // writes the dense matrix W with 3 size() rows
};

/// Sets present += factor (present - previous), and previous to the old value of present.
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
