#include "systems/dynamics/implicit/solve_large_step.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

/// Function of the node velocities v that the solution of the step minimises (docs/methods/implicit_bodies.md 8). With
/// the node masses M and the elastic energy U it is
///     inertia v.M v / 2 - v.impulse + U(unmoved_displacement + theta_h v)
/// For a free body U includes the energy of the spin at constant angular momentum. `impulse` and `unmoved_displacement`
/// are members of LargeStep.
class Objective {
public:
    Objective(Real inertia, Real theta_h, const StiffBody& stiff, LargeStep& step)
        : inertia_(inertia),
          theta_h_(theta_h),
          stiff_(stiff),
          step_(step),
          spins_(!stiff.is_held() && !step.angular_momentum.isZero(0)) {}

    /// Value of the function at step_.velocity + along step_.direction [J]. Writes the displacements for this velocity
    /// to step_.displacement_in_step.
    Real at(Real along) {
        Real sum = 0;
        for (std::size_t k = 0; k < step_.velocity.size(); ++k) {
            const Vec3 velocity = step_.velocity[k] + along * step_.direction[k];
            step_.displacement_in_step[k] = step_.unmoved_displacement[k] + theta_h_ * velocity;
            if (!stiff_.holds(k)) sum += velocity.dot(inertia_ / 2 * stiff_.mass(k) * velocity - step_.impulse[k]);
        }
        return sum + stiff_.elements().energy(step_.displacement_in_step) + spin_energy();
    }

    /// Computes the forces at the displacements step_.within, the gradient g of the function to be minimised, and the
    /// next Newton direction with the present factor of the matrix A. Returns the squared Newton decrement g.A^-1 g
    /// [J].
    Real evaluate() {
        stiff_.elements().forces(step_.displacement_in_step, step_.force);
        if (spins_) {
            const Vec3 spin = step_.shape.inertia().ldlt().solve(step_.angular_momentum);
            for (std::size_t k = 0; k < step_.velocity.size(); ++k)
                step_.force[k] += spin.cross(spin.cross(step_.shape.arm[k]));
        }
        for (std::size_t k = 0; k < step_.velocity.size(); ++k)
            step_.gradient[k] =
                inertia_ * stiff_.mass(k) * step_.velocity[k] + theta_h_ * step_.force[k] - step_.impulse[k];
        return solve_direction();
    }

    /// Computes the Newton direction with a new matrix factor and an unchanged gradient. Returns the squared Newton
    /// decrement [J].
    Real solve_direction() {
        for (std::size_t k = 0; k < step_.velocity.size(); ++k) step_.direction[k] = -step_.gradient[k];
        stiff_.respond(step_.direction);
        Real decrement = 0;
        for (std::size_t k = 0; k < step_.velocity.size(); ++k)
            if (!stiff_.holds(k)) decrement -= step_.gradient[k].dot(step_.direction[k]);
        return decrement;
    }

    /// Kinetic energy that elastic and centrifugal forces alone would give to the free nodes in the step [J].
    Real force_energy() const {
        Real sum = 0;
        for (std::size_t k = 0; k < step_.velocity.size(); ++k)
            if (!stiff_.holds(k)) sum += (theta_h_ * step_.force[k]).squaredNorm() / (2 * stiff_.mass(k));
        return sum;
    }

    /// Sum of kinetic energy, elastic energy and energy of the spin, which sets the scale of rounding errors [J].
    Real size() const {
        Real sum = 0;
        for (std::size_t k = 0; k < step_.velocity.size(); ++k)
            if (!stiff_.holds(k)) sum += stiff_.mass(k) * step_.velocity[k].squaredNorm() / 2;
        return sum + stiff_.elements().energy(step_.displacement_in_step) + spin_energy();
    }

private:
    /// Energy of the spin with the present angular momentum and the inertia of the shape within the step [J]. Its
    /// negative gradient is the centrifugal force.
    Real spin_energy() const {
        if (!spins_) return 0;
        stiff_.find_shape(step_.displacement_in_step, step_.shape);
        return step_.angular_momentum.dot(step_.shape.inertia().ldlt().solve(step_.angular_momentum)) / 2;
    }

    Real inertia_, theta_h_;
    const StiffBody& stiff_;
    LargeStep& step_;
    bool spins_;
};

bool find_velocity(Real inertia, Real theta_h, StiffBody& stiff) {
    // Limits of Newton's method, which ends when the decrement is small:
    // - `close`: at most this fraction of its first value
    // - `rounding`: its square is at most this fraction of the sum of all energies
    // - `slow_decrease`: an iteration that leaves more than this fraction of the decrement is followed by a new matrix
    //   factor
    constexpr Real close = 1e-3, rounding = 1e-13, slow_decrease = 0.1;
    constexpr int most_steps = 50, most_halvings = 20;
    LargeStep& step = stiff.large_step;
    step.counts = {.solved = 1};
    std::ranges::fill(step.direction, Vec3::Zero());
    Objective objective(inertia, theta_h, stiff, step);
    Real value = objective.at(0);
    const Real size = objective.size();
    const auto factor = [&] {
        ++step.counts.factors;
        return stiff.prepare_tangent(inertia, theta_h * theta_h, step.displacement_in_step);
    };
    if (!std::isfinite(value) || !factor()) return false;
    Real decrement = objective.evaluate();
    const Real first = decrement;
    // The start velocities are accepted if the decrement is only a rounding error. In a very short step it can be below
    // the rounding error of the energies although forces act. So it is also compared with the effect of these forces;
    // else the reactions of held nodes would be wrong.
    if (decrement <= rounding * std::min(size, objective.force_energy())) return true;
    for (int k = 0; k < most_steps; ++k) {
        if (!std::isfinite(decrement)) return false;
        if (k > 0 && decrement <= std::max(close * close * first, rounding * size)) return true;
        ++step.counts.steps;
        constexpr Real armijo = 1e-4;  // required decrease, as a fraction of the decrease that the slope predicts
        Real along = 1, next = objective.at(along);
        for (int halved = 0; !(next <= value - armijo * along * decrement + rounding * size); ++halved) {
            if (halved == most_halvings) return false;
            along /= 2;
            next = objective.at(along);
        }
        value = next;
        for (std::size_t n = 0; n < step.velocity.size(); ++n) step.velocity[n] += along * step.direction[n];
        const Real before = decrement;
        decrement = objective.evaluate();
        if (decrement > std::max(slow_decrease * slow_decrease * before, rounding * size)) {
            if (!factor()) return false;
            decrement = objective.solve_direction();
        }
    }
    return false;
}

}  // namespace

bool solve_large_step(Real inertia, Real theta_h, StiffBody& stiff) {
    stiff.large_step.failed = !find_velocity(inertia, theta_h, stiff);
    return !stiff.large_step.failed;
}

}  // namespace skerry
