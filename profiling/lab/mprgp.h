// Modified proportioning with reduced gradient projections (Dostal and Schoeberl 2005; docs/methods/region_solver.md
// 5.2): conjugate gradients with a consistent treatment of the active set, for contacts without friction. It works in
// the norm of the diagonal, since bounds keep their form when rows are scaled.
#pragma once

#include <algorithm>
#include <limits>

#include "profiling/lab/power_iteration.h"
#include "systems/solver/methods/error_test.h"

namespace skerry::lab {

/// Minimises x . W x / 2 + q . x over normal impulses x >= 0. Workspace 1 holds the gradient in component 0, workspace
/// 2 the direction (along the normals), and workspace 3 its product with W in component 0.
template <ContactOperator Op>
class ProportionedGradients {
public:
    explicit ProportionedGradients(Op& op) : op_(op) {}

    void start() {
        constexpr Index power_steps = 20;  // number of products, for an accuracy of a few percent
        constexpr Real margin = 1.1;       // safety factor: power iteration approaches the eigenvalue from below
        // Expansion step in units of 1/|A|. Lengths up to 2 converge (Dostal, Domoradova and Sadowska 2011), and longer
        // steps find the faces sooner.
        constexpr Real expansion = 1.8;
        const auto normal_part = [this](Index i, const Vec4& v) { return Vec4(op_.normal(i).dot(v) * op_.normal(i)); };
        for (Index i = 0; i < op_.size(); ++i) {
            const Real pressed = op_.normal(i).dot(op_.impulse()[i]);
            op_.impulse()[i] = pressed > 0 && diagonal(i) > 0 ? Vec4(pressed * op_.normal(i)) : Vec4(Vec4::Zero());
        }
        // The eigenvalue is relative to the mobility. The one relative to the diagonal is larger by at most 1 /
        // smallest_ratio.
        Real smallest_ratio = 1;
        for (Index i = 0; i < op_.size(); ++i)
            if (diagonal(i) > 0) smallest_ratio = std::min(smallest_ratio, diagonal(i) / op_.mobility(i));
        expansion_ = expansion * smallest_ratio / (margin * largest_eigenvalue(op_, power_steps, normal_part));
        refresh();
        point_along_free();
    }

    /// Does one step. Returns false if there is no direction left.
    bool advance() {
        Real chopped = 0, reduced = 0;
        for (Index i = 0; i < op_.size(); ++i) {
            const Real d = diagonal(i), g = gradient_[i][0], x = pressed(i);
            if (!(d > 0)) continue;
            if (x > 0) reduced += g * std::min(d * x / expansion_, g) / d;
            if (!(x > 0) && g < 0) chopped += g * g / d;
        }
        if (chopped <= reduced) return minimise_in_face();  // the iterate is proportional, with the paper's Gamma = 1
        for (Index i = 0; i < op_.size(); ++i) {
            const bool leaves = !(pressed(i) > 0) && gradient_[i][0] < 0 && diagonal(i) > 0;
            direction_[i] = leaves ? Vec4((gradient_[i][0] / diagonal(i)) * op_.normal(i)) : Vec4(Vec4::Zero());
        }
        const auto [slope, curvature] = multiply();
        if (!(curvature > 0)) return false;
        move(slope / curvature);
        point_along_free();
        return true;
    }

    /// Recomputes velocities and gradient from the present impulse.
    void refresh() {
        op_.refresh();
        op_.residual(gradient_);
        for (Index i = 0; i < op_.size(); ++i) gradient_[i] = Vec4(-op_.normal(i).dot(gradient_[i]), 0, 0, 0);
    }

private:
    struct Line {
        Real slope, curvature;
    };

    Real pressed(Index i) { return op_.normal(i).dot(op_.impulse()[i]); }
    /// Diagonal entry n . W_ii n. It is the mobility if the block is a multiple of the identity.
    Real diagonal(Index i) const {
        if constexpr (requires { op_.inner(i, op_.normal(i), op_.normal(i)); })
            return op_.mobility(i) > 0 ? op_.inner(i, op_.normal(i), op_.normal(i)) : 0;
        else
            return op_.mobility(i);
    }

    Line multiply() {
        op_.multiply(direction_, product_);
        Line line{0, 0};
        for (Index i = 0; i < op_.size(); ++i) {
            const Real along = op_.normal(i).dot(direction_[i]);
            product_[i] = Vec4(op_.normal(i).dot(product_[i]), 0, 0, 0);
            line.slope += gradient_[i][0] * along;
            line.curvature += product_[i][0] * along;
        }
        return line;
    }

    /// x -= length p. Components that reach their bound are set to it.
    void move(Real length) {
        for (Index i = 0; i < op_.size(); ++i) {
            const Real x = pressed(i) - length * op_.normal(i).dot(direction_[i]);
            op_.impulse()[i] = x > 0 ? Vec4(x * op_.normal(i)) : Vec4(Vec4::Zero());
            gradient_[i][0] -= length * product_[i][0];
        }
    }

    void point_along_free() {
        for (Index i = 0; i < op_.size(); ++i)
            direction_[i] = pressed(i) > 0 ? Vec4((gradient_[i][0] / diagonal(i)) * op_.normal(i)) : Vec4(Vec4::Zero());
    }

    /// Does a step of conjugate gradients. A step that would leave the bounds ends at the first of them, and a
    /// projected gradient step follows.
    bool minimise_in_face() {
        const auto [slope, curvature] = multiply();
        if (!(curvature > 0)) return false;
        Real longest = std::numeric_limits<Real>::infinity();
        Index first = no_index;
        for (Index i = 0; i < op_.size(); ++i) {
            const Real along = op_.normal(i).dot(direction_[i]);
            if (along > 0 && pressed(i) < longest * along) {
                longest = pressed(i) / along;
                first = i;
            }
        }
        if (slope / curvature <= longest) {
            move(slope / curvature);
            Real turn = 0;
            for (Index i = 0; i < op_.size(); ++i)
                if (pressed(i) > 0) turn += gradient_[i][0] * product_[i][0] / diagonal(i);
            turn /= curvature;
            for (Index i = 0; i < op_.size(); ++i) {
                const Real steepest = pressed(i) > 0 ? gradient_[i][0] / diagonal(i) : 0;
                direction_[i] = steepest * op_.normal(i) - turn * direction_[i];
            }
            return true;
        }
        move(longest);
        op_.impulse()[first].setZero();
        for (Index i = 0; i < op_.size(); ++i) {
            if (!(pressed(i) > 0)) continue;
            const Real x = pressed(i) - expansion_ * gradient_[i][0] / diagonal(i);
            op_.impulse()[i] = x > 0 ? Vec4(x * op_.normal(i)) : Vec4(Vec4::Zero());
        }
        refresh();
        point_along_free();
        return true;
    }

    Op& op_;
    std::span<Vec4> gradient_ = op_.workspace(1), direction_ = op_.workspace(2), product_ = op_.workspace(3);
    Real expansion_ = 1;  // length of the projected gradient step, in units of 1/D
};

/// Solves from the present impulse of the operator; an iteration is one step. Friction is ignored, and the error shows
/// this. Leaves the last impulse if it converged or the iteration count is fixed, else the best one.
template <ContactOperator Op>
SolveResult solve_mprgp(Op& op, const SolveLimits& limits) {
    constexpr Index refresh_interval = 64;  // steps; the updated gradient accumulates rounding errors
    ErrorTest<Op> test(op, limits);
    ProportionedGradients<Op> gradients(op);
    gradients.start();
    for (Index iteration = 1; iteration <= limits.max_iterations; ++iteration) {
        const bool going_on = gradients.advance();
        const bool measured =
            !limits.fixed_iterations && (!going_on || test.due(iteration) || iteration == limits.max_iterations);
        if (measured || iteration % refresh_interval == 0) gradients.refresh();
        if (!measured) continue;
        if (test.ends(iteration)) return test.result();
        if (!going_on) return test.give_up(iteration);
    }
    if (limits.fixed_iterations) op.refresh();
    return test.give_up(limits.max_iterations);
}

}  // namespace skerry::lab
