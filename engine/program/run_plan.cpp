#include "engine/program/run_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "skerry/error.h"

namespace skerry {

long RunPlan::frames() const {
    return std::max(1L, static_cast<long>(std::ceil(seconds / frame_step - slack)));
}

double RunPlan::length_of(long frame) const {
    // The last frame keeps its full length if only rounding makes it shorter. A longer run then has this frame at the
    // same time.
    const double left = seconds - static_cast<double>(frame) * frame_step;
    return left > (1 - slack) * frame_step ? frame_step : left;
}

bool RunPlan::even() const {
    if (!(probe_step > 0)) return true;
    const double ratio = frame_step / probe_step, whole = std::round(ratio);
    return whole > 0 && std::abs(ratio - whole) <= slack * whole;
}

std::vector<double> RunPlan::ends_in(long frame) const {
    const double begin = static_cast<double>(frame) * frame_step, length = length_of(frame), end = begin + length;
    if (!(probe_step > 0) || (even() && length >= (1 - slack) * frame_step)) return {};
    std::vector<double> ends;
    for (double k = std::floor(begin / probe_step + slack) + 1; k * probe_step < end - slack * probe_step; ++k)
        ends.push_back(k * probe_step);
    ends.push_back(end);
    return ends;
}

double RunPlan::longest_call() const {
    const double frame = std::min(frame_step, seconds);
    return probe_step > 0 ? std::min(frame, probe_step) : frame;
}

double RunPlan::longest_step(const World& world) const {
    const Real stable = world.stable_step();
    return std::min({longest_call(), stable, world.settings().step_size.value_or(stable)});
}

double RunPlan::steps(const World& world) const {
    // Only the first thousand frames are counted. The later ones have about the same mean number of steps.
    const long counted = std::min(frames(), 1000L);
    const double longest = longest_step(world);
    double count = 0, time = 0;
    for (long frame = 0; frame < counted; ++frame) {
        const double length = length_of(frame);
        const std::vector<double> ends = ends_in(frame);
        if (ends.empty()) count += samples * std::ceil(length / samples / longest - slack);
        double before = static_cast<double>(frame) * frame_step;
        for (const double end : ends) count += std::ceil((end - std::exchange(before, end)) / longest - slack);
        time += length;
    }
    return count * std::max(0.0, seconds - world.time()) / time;
}

bool cut_short(const RunPlan& plan, long frame, double planned) {
    RunPlan earlier = plan;
    earlier.seconds = planned;
    const double before = earlier.length_of(frame);
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
    RunPlan plan{.seconds = options.seconds.value_or(scene.seconds), .frame_step = scene.frame_step};
    if (options.frames_per_second) plan.frame_step = 1 / *options.frames_per_second;
    expect_countable_frames(options, plan);
    if (scene.probes.empty() && scene.recorded.empty()) return plan;
    plan.probe_step = scene.probe_step;
    const double samples = std::min(plan.frame_step, plan.seconds) / scene.probe_step;
    expect_countable(options, "samples of the probes per frame", samples, "increase probe_step");
    const bool whole = plan.even() && plan.frame_step <= plan.seconds;
    plan.samples = static_cast<int>(whole ? std::lround(samples) : std::lround(std::ceil(samples)) + 1);
    return plan;
}

RunPlan plan_run(const RunOptions& options, const RunMemory& memory, double time) {
    const RunPlan plan{options.seconds.value_or(memory.seconds), memory.frame_step, memory.samples, memory.probe_step};
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
