#include "engine/program/trial.h"

#include <algorithm>
#include <cmath>

#include "engine/program/progress.h"
#include "engine/program/start_text.h"
#include "engine/program/time_left.h"

namespace skerry {

namespace {

// CPU time after which a trial ends [s]. It is short because a person waits, but long enough for the first impacts of
// most scenes.
constexpr double longest_trial = 3;

/// Runs the trial and sets the measured and estimated costs.
void measure(World& world, const RunPlan& plan, SceneCost& cost) {
    const double until = cpu_seconds() + longest_trial;
    const auto go_on = [&](const StepReport&) { return cpu_seconds() < until; };
    const Real end = plan.seconds - RunPlan::slack * plan.frame_step;
    const Stopwatch watch;
    TimeLeft time_left(plan.seconds, world.time());
    while (!cost.complete) {
        const StepReport report =
            world.advance(std::clamp(plan.seconds - world.time(), 0.0, plan.longest_call()), go_on);
        cost.steps += static_cast<double>(report.steps);
        time_left.reach(watch.seconds(), world.time());
        if (report.status == StepStatus::stopped) break;
        if (!report.ok()) {
            cost.failure = report.message();
            break;
        }
        cost.complete = world.time() >= end;
    }
    cost.simulated = world.time();
    cost.seconds = watch.seconds();
    if (cost.complete) return;
    if (const double estimate = time_left.estimate(); std::isfinite(estimate)) cost.seconds += estimate;
    cost.steps += plan.steps(world);
}

}  // namespace

SceneCost try_run(World& world, const RunPlan& plan, Real overlap) {
    SceneCost cost{.overlap = overlap};
    // duration of a step that is long enough to find the contacts but moves hardly anything [s]
    constexpr Real tiny_step = 1e-9;
    const StepReport first = world.advance(tiny_step);
    cost.overlap = std::max(overlap, first.max_penetration);
    cost.into_shell = first.max_gap_violation - first.max_penetration;
    cost.contacts = first.contacts;
    if (!first.ok()) cost.failure = first.message();
    if (const WorldReport report = world.report(); report.collider_turn > visible_turn)
        cost.turning = turning_text(report);
    measure(world, plan, cost);
    return cost;
}

}  // namespace skerry
