#include "engine/program/run_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "skerry/error.h"

namespace skerry {

long RunPlan::frames() const {
    return std::max(1L, static_cast<long>(std::ceil(seconds / frame_step - slack)));
}

double RunPlan::length_of(long frame) const {
    return std::min(frame_step, seconds - static_cast<double>(frame) * frame_step);
}

double RunPlan::sample() const {
    return std::min(frame_step, seconds) / samples;
}

double RunPlan::longest_step(const World& world) const {
    const Real stable = world.stable_step();
    return std::min({frame_step / samples, seconds / samples, stable, world.settings().step_size.value_or(stable)});
}

double RunPlan::steps(const World& world) const {
    return std::max(0.0, seconds - world.time()) / sample() * std::ceil(sample() / longest_step(world));
}

bool cut_short(const RunPlan& plan, long frame, double planned) {
    const double before = RunPlan{planned, plan.frame_step, plan.samples}.length_of(frame);
    const bool within = before > RunPlan::slack * plan.frame_step && before < (1 - RunPlan::slack) * plan.frame_step;
    return within && before != plan.length_of(frame);
}

namespace {

void expect_countable(const RunOptions& options, const char* field, double count, const char* hint) {
    constexpr double most = 1e9;
    if (count <= most) return;
    char found[64];
    std::snprintf(found, sizeof found, "%g", count);
    Complaint{.file = options.scene.string(),
              .object = "run",
              .field = field,
              .found = found,
              .expected = "at most 1e9",
              .hint = hint}
        .raise();
}

void expect_countable_frames(const RunOptions& options, const RunPlan& plan) {
    expect_countable(options, "frames", plan.seconds / plan.frame_step,
                     "reduce seconds (--seconds) or --frames-per-second, or increase frame_step");
}

}  // namespace

RunPlan plan_run(const Scene& scene, const RunOptions& options) {
    RunPlan plan{options.seconds.value_or(scene.seconds), scene.frame_step, 1};
    if (options.frames_per_second) plan.frame_step = 1 / *options.frames_per_second;
    expect_countable_frames(options, plan);
    if (scene.probes.empty() && scene.recorded.empty()) return plan;
    const double samples = std::min(plan.frame_step, plan.seconds) / scene.probe_step;
    expect_countable(options, "samples of the probes per frame", samples, "increase probe_step");
    plan.samples = std::max(1, static_cast<int>(std::lround(samples)));
    return plan;
}

RunPlan plan_run(const RunOptions& options, const RunMemory& memory, double time) {
    const RunPlan plan{options.seconds.value_or(memory.seconds), memory.frame_step, memory.samples};
    expect_countable_frames(options, plan);
    if (plan.seconds > time + RunPlan::slack * plan.frame_step) return plan;
    char found[128], expected[128];
    std::snprintf(found, sizeof found, "a checkpoint at %g s", time);
    std::snprintf(expected, sizeof expected, "a checkpoint from before the end of the run, which is at %g s",
                  plan.seconds);
    Complaint{.file = options.restart.string(),
              .object = "--restart",
              .field = {},
              .found = found,
              .expected = expected,
              .hint = "choose a larger --seconds"}
        .raise();
}

}  // namespace skerry
