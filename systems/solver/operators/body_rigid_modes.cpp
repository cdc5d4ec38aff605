// Coarse correction with rigid-body modes: Newton steps in which deformable bodies move as rigid bodies. Deformations
// are updated once per round, which is a sequence of Newton steps with fixed start impulses
// (docs/methods/region_solver.md 5.10).
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "systems/solver/operators/body_operator.h"

namespace skerry {

/// True if the rigid motion of the body of `term` is an unknown. A held body has no rigid motion.
bool BodyOperator::moves_rigidly(const BodyEquations& equations, const RigidTerm& term) const {
    if (!traversal_.deforms(term.row)) return true;
    return equations.rigid_modes && traversal_.rigid().inverse_mass(static_cast<std::size_t>(term.row)) > 0;
}

bool BodyOperator::is_unknown(const BodyEquations& equations, Index node) const {
    return !(equations.rigid_modes && traversal_.moves_with_rigid(node));
}

/// True if the coarse correction pays off. With few contacts per body, sweeps alone are faster. For example, piles of
/// cubes with 27 nodes have about 20 contacts per body; with the correction they would take a sixth longer.
bool BodyOperator::corrects_rigid_modes() const {
    constexpr Index many = 48;  // contacts per body
    if (!runs_ || touches_clusters()) return false;
    bool any_free = false;
    Index bodies = 0;
    for (const RigidPart& part : memory_.part)
        for (const RigidTerm& term : part.terms()) {
            const bool held = !(traversal_.rigid().inverse_mass(static_cast<std::size_t>(term.row)) > 0);
            any_free = any_free || (traversal_.deforms(term.row) && !held);
            bodies = std::max(bodies, term.slot / 2 + 1);
        }
    return any_free && size() >= many * bodies;
}

BodyEquations* BodyOperator::rigid_mode_memory() {
    if (!newton_) newton_ = pool_->lease();
    BodyEquations& equations = newton_->rigid_modes;
    if (!std::exchange(rigid_modes_are_listed_, true)) {
        equations.rigid_modes = true;
        list_equations(equations);
        if (std::isfinite(equations.cost())) assemble(equations);
    }
    return std::isfinite(equations.cost()) ? &equations : nullptr;
}

/// Computes and stores the velocities that the present impulses produce, including deformations. The deformation
/// velocities stay fixed during the round.
void BodyOperator::start_rigid_round(BodyEquations& equations) {
    refresh();
    std::ranges::copy(memory_.velocity, memory_.scratch.begin());
    gather(equations, equations.present);
    equations.offset.resize(static_cast<std::size_t>(size()));
    for (Index i = 0; i < size(); ++i)
        equations.offset[static_cast<std::size_t>(i)] =
            velocity(i).head<3>() - equations.velocity(i, equations.present.span());
}

/// Updates the velocities for the change of the impulses since the start of the round, without deforming implicit
/// bodies. `start`: impulses at the start. `scratch` holds the velocities that these impulses produce.
void BodyOperator::push_rigid_modes(std::span<const Vec4> start) {
    std::ranges::copy(memory_.scratch, memory_.velocity.begin());
    for (Index i = 0; i < size(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        apply_undeformed(i, memory_.impulse[at] - start[at], memory_.velocity.data());
    }
}

SolveResult BodyOperator::correct_rigid_modes(Real error, Real tolerance, Index limit) {
    // Compliance of the contacts in a round, as a fraction of the mobility D. It replaces the deformation of the
    // bodies, which a round leaves out. If it is below the compliance of the bodies, rounds reduce the error too
    // little.
    constexpr Real softness = 0.3;
    // A round ends when sqrt(d . K d), the square root of the merit function, is at most `enough` scale_ e, where e is
    // the relative error of the region at the start of the round, and scale_ its scale [sqrt(J)].
    constexpr Real enough = 0.01;
    // Another round follows if the error after a round is below this fraction of the error before the round.
    constexpr Real gain = 0.5;
    constexpr Index max_steps_in_round = 14;  // upper limit on the number of steps per round
    SolveResult result{0, error, error <= tolerance};
    BodyEquations* const equations = rigid_mode_memory();
    if (equations == nullptr) return result;
    const std::span<Vec4> start = memory_.workspace[1], best = memory_.workspace[2];
    std::ranges::copy(memory_.impulse, best.begin());
    equations->softness = softness;
    bool goes_on = !result.converged;
    while (goes_on) {
        std::ranges::copy(memory_.impulse, start.begin());
        start_rigid_round(*equations);
        equations->start_round();
        std::optional<Real> merit = evaluate_motion(*equations, start, Evaluation::matrix);
        for (Index steps = 0; merit && steps < max_steps_in_round && result.iterations < limit; ++steps) {
            if (std::sqrt(*merit) <= enough * scale_ * result.error) break;
            ++result.iterations;
            merit = step_motion(*equations, start, *merit);
        }
        if (!merit) break;
        refresh();
        const Real now = this->error();
        goes_on = now < gain * result.error && now > tolerance && result.iterations < limit;
        if (!(now < result.error)) break;
        result = {result.iterations, now, now <= tolerance};
        std::ranges::copy(memory_.impulse, best.begin());
    }
    std::ranges::copy(best, memory_.impulse.begin());
    refresh();
    return result;
}

}  // namespace skerry
