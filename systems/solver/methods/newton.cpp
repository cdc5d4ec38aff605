#include "systems/solver/methods/newton.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "systems/solver/methods/pgs.h"

namespace skerry {
namespace {

/// P(z) and its derivative: P(z) is the impulse of Coulomb's law for a contact that the impulse z would stop.
struct CoulombImpulse {
    Vec3 impulse;
    Mat3 derivative;
};

CoulombImpulse coulomb_impulse(const Vec3& z, const Vec3& normal, FrictionLimits limits) {
    if (limits.ties())
        return {project_tie(z, normal, limits),
                limits.stick == 0 ? Mat3(normal * normal.transpose()) : Mat3::Identity()};
    const Real mu = limits.slide;
    const Real along = normal.dot(z);
    if (!(along > 0)) return {Vec3::Zero(), Mat3::Zero()};
    const Vec3 tangential = z - along * normal;
    const Real length = tangential.norm();
    if (length <= mu * along) return {z, Mat3::Identity()};
    const Vec3 h = tangential / length;
    const Mat3 pressing = normal * normal.transpose();
    const Mat3 turning = (mu * along / length) * (Mat3::Identity() - pressing - h * h.transpose());
    return {along * normal + mu * along * h, pressing + turning + mu * h * normal.transpose()};
}

/// Newton steps on the natural map F_i(r) = r_i - P(r_i - u_i / D_i), with the impulses r, the contact velocities u and
/// the scalar mobilities D. P(z) is the impulse of Coulomb's law for a contact that the impulse z would stop. All slots
/// of the operator's workspace may be overwritten except slot 0, which holds the best iterate of the caller.
class NewtonSteps {
public:
    NewtonSteps(AnyOperator& op, NewtonMemory& memory)
        : op_(op), memory_(memory), impulse_(op.impulse()), negative_velocity_(op.workspace(3)) {
        op_.assemble(memory_.operator_matrix);
        memory_.change.resize(3 * op_.size());
        memory_.contact.clear();
        for (Index i = 0; i < op_.size(); ++i)
            memory_.contact.push_back({op_.normal(i), op_.mobility(i), op_.limits(i)});
    }

    /// Takes at most `limit` steps, until the error is within the tolerance or several steps in a row do not lower it.
    /// Single steps may raise it, as long as the sets of sticking and sliding contacts are not yet correct. The final
    /// impulse is the best one. `error`: error of the present impulse.
    SolveResult run(Real error, Real tolerance, Index limit) {
        constexpr Index patience = 4;  // number of steps without a lower error before giving up (docs/decisions/0004)
        const std::span<Vec4> best = op_.workspace(2);
        SolveResult result{0, error, error <= tolerance};
        std::ranges::copy(impulse_, best.begin());
        Index best_at = 0;
        while (!result.converged && result.iterations < limit && result.iterations - best_at < patience) {
            ++result.iterations;
            if (!find_change()) break;
            search_along_change();
            const Real next = op_.error();
            if (!(next < result.error)) continue;
            std::ranges::copy(impulse_, best.begin());
            best_at = result.iterations;
            result.error = next;
            result.converged = next <= tolerance;
        }
        if (best_at < result.iterations) {
            std::ranges::copy(best, impulse_.begin());
            op_.refresh();
        }
        return result;
    }

private:
    CoulombImpulse law_impulse(Index i) {
        const NewtonMemory::Contact& contact = memory_.contact[i];
        const Vec4 z = impulse_[i] + negative_velocity_[i] / contact.mobility;
        return coulomb_impulse(z.head<3>(), contact.normal.head<3>(), contact.mu);
    }

    /// Computes the Newton step d. Contacts that open get zero impulse. All others solve J d = -F with the Jacobian J
    /// of the natural map F. Returns false if the factorisation broke down.
    bool find_change() {
        op_.residual(negative_velocity_);
        memory_.active.clear();
        memory_.change.setZero();
        for (Index i = 0; i < op_.size(); ++i) {
            const NewtonMemory::Contact& contact = memory_.contact[i];
            const Vec4 z = contact.mobility > 0 ? Vec4(impulse_[i] + negative_velocity_[i] / contact.mobility)
                                                : Vec4(Vec4::Zero());
            if (contact.normal.dot(z) > 0 || (contact.mu.ties() && contact.mobility > 0)) {
                memory_.active.push_back(i);
            } else {
                memory_.change.segment<3>(3 * i) = -impulse_[i].head<3>();
            }
        }
        const Eigen::Index count = static_cast<Eigen::Index>(memory_.active.size());
        if (count == 0) return memory_.change.allFinite();
        memory_.jacobian.resize(3 * count, 3 * count);
        memory_.rest.resize(3 * count);
        fill_equations();
        solve_equations();
        for (Eigen::Index a = 0; a < count; ++a)
            memory_.change.segment<3>(3 * memory_.active[static_cast<std::size_t>(a)]) = memory_.rest.segment<3>(3 * a);
        return memory_.change.allFinite();
    }

    /// Fills the Jacobian J = I - P' (I - D^-1 W) of the natural map F, and the right-hand side -F, with the derivative
    /// P' of P, the mobilities D and the Delassus operator W. The right-hand side includes the effect of the opening
    /// contacts, whose impulses become zero.
    void fill_equations() {
        // If there are more sticking contacts than the bodies have degrees of freedom, their impulses are not unique,
        // and the matrix is singular. A small multiple of the identity selects one solution. It changes the steps but
        // not the solution.
        constexpr Real redundancy = 1e-8;
        const std::vector<Index>& active = memory_.active;
        for (std::size_t a = 0; a < active.size(); ++a) {
            const Index i = active[a];
            const auto row = memory_.operator_matrix.middleRows<3>(3 * i);
            const CoulombImpulse coulomb = law_impulse(i);
            const Mat3 scaled_derivative = coulomb.derivative / memory_.contact[i].mobility;
            const Eigen::Index first_row = static_cast<Eigen::Index>(3 * a);
            memory_.rest.segment<3>(first_row) =
                coulomb.impulse - impulse_[i].head<3>() - scaled_derivative * (row * memory_.change);
            for (std::size_t b = 0; b < active.size(); ++b)
                memory_.jacobian.block<3, 3>(first_row, static_cast<Eigen::Index>(3 * b)) =
                    scaled_derivative * row.middleCols<3>(3 * active[b]);
            memory_.jacobian.block<3, 3>(first_row, first_row) +=
                (1 + redundancy) * Mat3::Identity() - coulomb.derivative;
        }
    }

    /// Solves jacobian x = rest. The solution overwrites `rest`, the factors overwrite `jacobian`.
    void solve_equations() {
        const Eigen::PartialPivLU<Eigen::Ref<Eigen::MatrixXd>> factors(memory_.jacobian);
        memory_.rest = factors.solve(memory_.rest);
    }

    /// Returns the merit function: the sum of D |F|^2 over the contacts, with the natural map F and the mobility D [J].
    /// Writes -u to `negative_velocity_`.
    Real merit() {
        op_.residual(negative_velocity_);
        Real sum = 0;
        for (Index i = 0; i < op_.size(); ++i) {
            const Real mobility = memory_.contact[i].mobility;
            if (mobility > 0) sum += mobility * (law_impulse(i).impulse - impulse_[i].head<3>()).squaredNorm();
        }
        return sum;
    }

    void move_along_change(Real length) {
        const std::span<const Vec4> start = op_.workspace(1);
        for (Index i = 0; i < op_.size(); ++i)
            impulse_[i] = op_.project(i, start[i] + length * padded(memory_.change.segment<3>(3 * i)));
        op_.refresh();
    }

    /// Line search: evaluates the step lengths 1, 1/2, 1/4, ... and takes the first one that lowers the merit to less
    /// than `enough` times its start value. If there is none, takes the length with the smallest merit.
    void search_along_change() {
        constexpr int halvings = 6;   // number of step lengths to evaluate (docs/decisions/0004)
        constexpr Real enough = 0.9;  // the merit function must fall below this fraction of its start value
        std::ranges::copy(impulse_, op_.workspace(1).begin());
        const Real start = merit();
        Real least = infinity, best_length = 1;
        for (int k = 0; k < halvings; ++k) {
            const Real length = std::ldexp(Real(1), -k);
            move_along_change(length);
            const Real now = merit();
            if (now < least) {
                least = now;
                best_length = length;
            }
            if (now < enough * start) return;
        }
        move_along_change(best_length);
    }

    AnyOperator& op_;
    NewtonMemory& memory_;
    std::span<Vec4> impulse_, negative_velocity_;  // negative_velocity_ is the negative contact velocity -u [m/s]
};

}  // namespace

SolveResult take_newton_steps(AnyOperator& op, NewtonMemory& memory, Real error, Real tolerance, Index limit) {
    return NewtonSteps(op, memory).run(error, tolerance, limit);
}

SolveResult solve_newton(AnyOperator& op, const SolveLimits& limits) {
    if (limits.fixed_iterations || op.law() != Friction::cone) return solve_pgs(op, limits);
    NewtonMemory memory;
    NewtonSteps steps(op, memory);
    BestIterate<AnyOperator> best(op);
    constexpr Index first_sweeps = 10, max_steps = 30;  // chosen by hand
    Index done = 0;
    for (Index sweeps = first_sweeps; done < limits.max_iterations; sweeps *= 2) {
        const Index pause = std::min(sweeps, limits.max_iterations - done);
        for (Index k = 0; k < pause; ++k) op.sweep(limits.relaxation);
        done += pause;
        const SolveResult result =
            steps.run(op.error(), limits.tolerance, std::min(max_steps, limits.max_iterations - done));
        done += result.iterations;
        if (result.converged || !std::isfinite(result.error)) return {done, result.error, result.converged};
        best.offer(result.error);
    }
    const Real error = best.restore();
    return {done, error, error <= limits.tolerance};
}

}  // namespace skerry
