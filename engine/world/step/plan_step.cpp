// The length of the next step, and the position of this step within a long step of implicit bodies
// (docs/step_length.md).
#include <algorithm>
#include <cmath>

#include "engine/world/step/step.h"
#include "systems/dynamics/rigid/rigid_motion.h"

namespace skerry {

Real fastest_spin(const Model& model, Index* body) {
    const RigidBodyTable& rigid = model.rigid_bodies;
    Real fastest = 0;
    const auto take = [&](Index of) {
        if (of == no_index || !model.has_frame(static_cast<std::size_t>(of))) return;
        const auto r = static_cast<std::size_t>(model.bodies.rigid[static_cast<std::size_t>(of)].begin);
        const Real spin = spin_of(rigid.rotation[r], rigid.moments[r], rigid.angular_momentum[r]).norm();
        if (!(spin > fastest)) return;
        fastest = spin;
        if (body) *body = of;
    };
    for (std::size_t j = 0; j < model.joints.slot.size(); ++j) {
        take(model.joints.first[j]);
        take(model.joints.second[j]);
    }
    for (std::size_t t = 0; t < model.ties.size(); ++t) {
        if (!model.ties.holds(t)) continue;
        take(model.ties.first[t]);
        take(model.ties.second[t]);
    }
    return fastest;
}

Real step_of_turns(const Model& model, Real shorter_than, Index& fastest) {
    // Largest rotation of a body with a joint or tie in a step [rad]. The equations of joints and ties use the
    // directions at the start of the step. The resulting errors of energy and position grow with the rotation.
    constexpr Real largest_turn = 0.1;
    Index body = no_index;
    Real spin = fastest_spin(model, &body);
    if (model.of_ranks.spinning != no_index && model.of_ranks.spin >= spin) {
        spin = model.of_ranks.spin;
        body = no_index;
    }
    if (!(spin * shorter_than > largest_turn)) return shorter_than;
    fastest = body;
    return largest_turn / spin;
}

StepPlan plan_step(const Model& model, Real remaining, Real fast_limit) {
    StepPlan plan;
    plan.stable = longest_allowed_step(model, &plan.stiffest);
    Index fastest = no_index;
    plan.regular = step_of_turns(model, plan.stable, fastest);
    const Real longest = std::min(plan.stable, fast_limit);
    // The tolerance prevents an extra step for a remaining time that is only a rounding error.
    plan.steps = std::isfinite(longest) ? std::max(1.0, std::ceil(remaining / longest - 1e-9)) : 1.0;
    plan.h = remaining / plan.steps;
    return plan;
}

bool forces_follow_implicit_bodies(const Model& model) {
    const auto acts = [](const Column<Real>& bound, std::size_t body) { return !bound.empty() && bound[body] > 0; };
    for (const Index body : model.rigid_bodies.body) {
        const auto b = static_cast<std::size_t>(body);
        if (!model.is_rigid(b) &&
            (acts(model.force_rate, b) || acts(model.force_damping, b) || acts(model.force_drag, b)))
            return true;
    }
    return std::ranges::any_of(model.cables.anchor.body, [&](Index body) {
        const auto b = static_cast<std::size_t>(body);
        return body != no_index && model.has_frame(b) && !model.is_rigid(b);
    });
}

Real time_to_end_of_long_step(const Model& model, Real remaining, LongStepClock& clock) {
    if (!(model.settings.implicit_step > 0)) return remaining;
    if (model.implicit_nodes.size() == 0 && !model.of_ranks.has_implicit) return remaining;
    if (clock.length == 0) {
        if (model.of_ranks.follow_implicit || forces_follow_implicit_bodies(model)) return remaining;
        // The tolerance prevents an extra long step for a remaining time that is only a rounding error.
        const Real count = std::max(1.0, std::ceil(remaining / model.settings.implicit_step - 1e-9));
        clock.length = clock.remaining = remaining / count;
    }
    return clock.remaining;
}

LongStepTimes times_in_long_step(const LongStepClock& clock, const StepPlan& plan) {
    const LongStepTimes times{clock.length, clock.remaining == clock.length, plan.steps == 1};
    // a long step that consists of one step is treated like an ordinary step
    return times.starts && times.ends ? LongStepTimes{} : times;
}

void move_on_in_long_step(const StepPlan& plan, LongStepClock& clock) {
    if (plan.steps > 1)
        clock.remaining -= plan.h;
    else
        clock = {};
}

}  // namespace skerry
