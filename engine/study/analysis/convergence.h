// Error of a computed value, estimated from runs with several edge lengths, step lengths or tolerances
// (docs/methods/study.md 1).
#pragma once

#include <limits>
#include <vector>

#include "components/types.h"

namespace skerry {

/// A value computed with one edge length, step length or tolerance.
struct ConvergenceLevel {
    Real h;  // edge length, step length or tolerance, relative to that of the scene as it is
    Real value;
};

/// Range of the orders of convergence that the theory predicts. `least` holds for results of poor smoothness.
struct TheoryOrder {
    Real least = 2, most = 2;
};

/// Behaviour of the differences between successive levels.
/// - unmeasured: there is only one level, or no level with h = 1.
/// - two_levels: there are two levels, or three without a constant ratio of h. Their differences give no order.
/// - coarse: two levels differ so much that both have large errors, and no third level shows that the differences
///   decrease.
/// - regular: the observed order is near that of the theory.
/// - equal: the finest two levels do not differ by more than the noise, which is the size of differences without
///   meaning, for example of rounding errors.
/// - slow: the observed order is far below that of the theory, or the differences grow.
/// - fast: the observed order is far above that of the theory, so the coarse levels do not converge with the order of
///   the theory yet.
/// - oscillating: successive differences have opposite signs.
enum class ConvergenceShape { unmeasured, two_levels, coarse, regular, equal, slow, fast, oscillating };

/// Error of a value, and its limit for vanishing h.
class Convergence {
public:
    Convergence() = default;
    /// `noise`: size of differences without meaning, for example rounding errors. `size`: typical size of the value;
    /// levels that differ by more than 30 % of it are too coarse for an order of convergence. Levels with values that
    /// are not finite are omitted. Without a level with h = 1, or with only one level, the error stays unmeasured.
    Convergence(std::vector<ConvergenceLevel> levels, TheoryOrder theory, Real noise, Real size = infinity);

    ConvergenceShape shape() const { return shape_; }
    /// Observed order; NaN unless three levels with a constant ratio of h differ by more than the noise.
    Real order() const { return order_; }
    /// True if the shape does not allow extrapolation: coarse, slow, fast or oscillating.
    bool irregular() const;
    /// Error bound of the value at h = 1, with a safety factor; NaN if unmeasured.
    Real error() const { return error_at(1); }
    /// Error bound of the value at `h`. NaN if the error is unmeasured, or if h is not a level and not below the finest
    /// one. For h below the finest level, the bound of that level is reduced by the order of convergence; for the
    /// shapes coarse, slow and oscillating it is not reduced.
    Real error_at(Real h) const;
    /// Error bound of any other approximation of the same limit; NaN if unmeasured.
    Real error_of(Real value) const;
    /// Value extrapolated to vanishing h, and its error bound. Without an order: the value of the finest level. NaN if
    /// unmeasured or irregular.
    Real limit() const;
    Real limit_error() const;

private:
    void find_order(TheoryOrder theory, Real noise, Real size);

    std::vector<ConvergenceLevel> levels_{};  // levels from coarse to fine
    ConvergenceShape shape_ = ConvergenceShape::unmeasured;
    Real order_ = std::numeric_limits<Real>::quiet_NaN();
    Real used_order_ = 1;   // order with which errors are predicted
    Real remainder_ = 0;    // estimated error of the finest level
    Real least_error_ = 0;  // error bounds of all levels are at least this large
};

}  // namespace skerry
