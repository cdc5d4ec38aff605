// Newton steps of regions of bodies that deform, as if these moved as wholes: what impulses make them deform by is
// looked at from round to round (docs/methods/region_solver.md 5.10).
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "systems/solver/operators/freedom_operator.h"

namespace skerry {

/// What is held does not move as a whole.
bool FreedomOperator::is_whole(const BodyEquations& equations, const RigidTerm& term) const {
    if (!walk_.deforms(term.row)) return true;
    return equations.wholes && walk_.rigid().inverse_mass(static_cast<std::size_t>(term.row)) > 0;
}

bool FreedomOperator::is_unknown(const BodyEquations& equations, Index node) const {
    return !(equations.wholes && walk_.moves_with_rigid(node));
}

/// Of few contacts a body sweeps are through by themselves: piles of cubes of 27 nodes have some 20, and cost a sixth
/// more with rounds.
bool FreedomOperator::moves_wholes() const {
    constexpr Index many = 48;  // contacts a body
    if (!runs_ || touches_clusters()) return false;
    bool any_free = false;
    Index bodies = 0;
    for (const RigidPart& part : memory_.part)
        for (const RigidTerm& term : part.terms()) {
            const bool held = !(walk_.rigid().inverse_mass(static_cast<std::size_t>(term.row)) > 0);
            any_free = any_free || (walk_.deforms(term.row) && !held);
            bodies = std::max(bodies, term.slot / 2 + 1);
        }
    return any_free && size() >= many * bodies;
}

BodyEquations* FreedomOperator::wholes_memory() {
    if (!newton_) newton_ = pool_->lease();
    BodyEquations& equations = newton_->wholes;
    if (!std::exchange(wholes_are_listed_, true)) {
        equations.wholes = true;
        list_equations(equations);
        if (std::isfinite(equations.cost())) assemble(equations);
    }
    return std::isfinite(equations.cost()) ? &equations : nullptr;
}

/// Velocities become those that the impulses make, as they are, and are kept: in the round what deforms goes on so.
void FreedomOperator::start_round_of_wholes(BodyEquations& equations) {
    refresh();
    std::ranges::copy(memory_.velocity, memory_.scratch.begin());
    gather(equations, equations.present);
    equations.offset.resize(static_cast<std::size_t>(size()));
    for (Index i = 0; i < size(); ++i)
        equations.offset[static_cast<std::size_t>(i)] =
            velocity(i).head<3>() - equations.velocity(i, equations.present.span());
}

/// Velocities of wholes become those that the impulses make, from those of the impulses `start`, which are kept.
void FreedomOperator::push_wholes(std::span<const Vec4> start) {
    std::ranges::copy(memory_.scratch, memory_.velocity.begin());
    for (Index i = 0; i < size(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        push(i, memory_.impulse[at] - start[at], memory_.velocity.data());
    }
}

SolveResult FreedomOperator::take_rounds_of_wholes(Real error, Real tolerance, Index limit) {
    constexpr Real softness = 0.3;       // of D: above what bodies deform by, or rounds gain nothing
    constexpr Real enough = 0.01;        // of the error at the start of a round, for it to be at its end
    constexpr Real gain = 0.5;           // of the error in a round, for another to follow
    constexpr Index most_in_round = 14;  // steps
    SolveResult result{0, error, error <= tolerance};
    BodyEquations* const equations = wholes_memory();
    if (equations == nullptr) return result;
    const std::span<Vec4> start = memory_.workspace[1], best = memory_.workspace[2];
    std::ranges::copy(memory_.impulse, best.begin());
    equations->softness = softness;
    bool goes_on = !result.converged;
    while (goes_on) {
        std::ranges::copy(memory_.impulse, start.begin());
        start_round_of_wholes(*equations);
        equations->start_round();
        std::optional<Real> lack = answer_motion(*equations, start, Look::matrix);
        for (Index steps = 0; lack && steps < most_in_round && result.iterations < limit; ++steps) {
            if (std::sqrt(*lack) <= enough * scale_ * result.error) break;
            ++result.iterations;
            lack = step_motion(*equations, start, *lack);
        }
        if (!lack) break;
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
