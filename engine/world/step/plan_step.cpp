// How long the next step is, and which elements get an impulse in it (multirate, docs/integration.md).
//
// Steps come in cycles of 2^levels. An element of level l gets one impulse in 2^l steps, in the middle of the time that
// it stands for, so that coarse elements are integrated to second order. An impulse is as long as the time that it has
// to cover, and gives equal and opposite parts to the corners at one moment: momentum and angular momentum are kept
// (asynchronous variational integrators: Lew, Marsden, Ortiz, West 2003). Nodes and contacts move on in every step.
#include <algorithm>
#include <cmath>

#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// 64 steps: what is coarser gains less than the nodes and contacts cost, which move in every step.
constexpr int most_cycle_levels = 6;

/// How many times the own step of a body is halved to the step of the world.
int level_of_body(const Model& model, std::size_t b, Real h) {
    constexpr int most = step_level_count - element_level_count;
    if (model.bodies.blocks[b].size() == 0) return 0;
    const Real ratio = model.bodies.stable_step[b] * model.settings.step_safety / h;
    constexpr Real rounding = 1e-9;
    return ratio > 1 ? static_cast<int>(std::min<Real>(most, std::log2(ratio * (1 + rounding)))) : 0;
}

/// Gives bodies their levels for a cycle of steps of length h, of which `steps` are left.
void begin_cycle(Model& model, StepCycle& cycle, Real h, Real steps) {
    cycle.index = cycle.levels = 0;
    cycle.h = h;
    if (!model.settings.multirate) return;
    cycle.elements.fill(0);
    int top = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        const int level = level_of_body(model, b, h);
        model.bodies.level[b] = static_cast<std::uint8_t>(level);
        for (int k = 0; k < element_level_count; ++k) {
            const Index count = model.bodies.level_count[b][static_cast<std::size_t>(k)];
            if (count == 0) continue;
            cycle.elements[static_cast<std::size_t>(level + k)] += static_cast<std::uint64_t>(count);
            top = std::max(top, level + k);
        }
    }
    // A cycle ends no later than the time asked for.
    const int fitting = static_cast<int>(std::log2(steps));
    cycle.levels = std::min({top, fitting, most_cycle_levels});
}

}  // namespace

StepPlan plan_step(Model& model, StepCycle& cycle, Real left, Real fast_limit) {
    const bool between = cycle.index == 0;
    StepPlan plan;
    plan.stable = trusted_step(model, &plan.stiffest);
    const Real longest = std::min(between ? plan.stable : cycle.h, fast_limit);
    // A remainder of rounding size joins the last step.
    plan.steps = std::isfinite(longest) ? std::max(1.0, std::ceil(left / longest - 1e-9)) : 1.0;
    plan.h = left / plan.steps;
    if (between) begin_cycle(model, cycle, plan.h, plan.steps);
    return plan;
}

void find_active_levels(const StepCycle& cycle, BodyTable& bodies, StepParameters& parameters) {
    const Real h = parameters.h;
    for (int l = 0; l < step_level_count; ++l) {
        const int period = 1 << std::min(l, cycle.levels), place = cycle.index % period;
        Real& duration = parameters.active.duration[static_cast<std::size_t>(l)];
        duration = 0;
        if (place != period / 2) continue;
        // To the end of its period; ahead of time already only where a cycle was broken off or its steps shortened.
        duration = std::max(0.0, ((period - place) * h - cycle.lead[static_cast<std::size_t>(l)]) / h);
    }
    const LevelMask mask = parameters.active.mask();
    for (std::size_t b = 0; b < bodies.slot.size(); ++b)
        bodies.active[b] = static_cast<LevelMask>(mask >> bodies.level[b]);
}

void count_impulses(const StepParameters& parameters, StepCycle& cycle, RunCounters& counters) {
    for (std::size_t l = 0; l < step_level_count; ++l) {
        const Real duration = parameters.active.duration[l];
        cycle.lead[l] += duration * parameters.h - parameters.h;
        counters.element_steps += cycle.elements[l];
        if (duration > 0) counters.element_impulses += cycle.elements[l];
    }
    cycle.index = (cycle.index + 1) % (1 << cycle.levels);
}

}  // namespace skerry
