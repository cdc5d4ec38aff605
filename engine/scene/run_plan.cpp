#include "engine/scene/run_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/complaint.h"

namespace skerry {

namespace {

void expect_countable(const std::filesystem::path& file, const char* field, double count, const char* hint) {
    constexpr double most = 1e9;
    if (count <= most) return;
    refuse_in(file.string(), "run", field, short_text(count, 6), "at most 1e9", hint);
}

}  // namespace

long RunPlan::frames() const {
    return std::max(1L, static_cast<long>(std::ceil(seconds / frame_step - slack)));
}

double RunPlan::length_of(long frame) const {
    // If only rounding shortens the last frame, the frame keeps its full length, so that a longer run has a frame at
    // the same time.
    const double remaining = seconds - static_cast<double>(frame) * frame_step;
    return remaining > (1 - slack) * frame_step ? frame_step : remaining;
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
    // Only the first thousand frames are counted, which limits the computing time. The later frames have about the same
    // mean number of steps.
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

void RunPlan::require_countable(const std::filesystem::path& file) const {
    expect_countable(file, "frames", seconds / frame_step,
                     "reduce seconds (--seconds) or --frames-per-second, or increase frame_step");
}

RunPlan plan_run(const Scene& scene, const std::filesystem::path& file, std::optional<Real> seconds,
                 std::optional<Real> frames_per_second) {
    RunPlan plan{.seconds = seconds.value_or(scene.seconds), .frame_step = scene.frame_step};
    if (frames_per_second) plan.frame_step = 1 / *frames_per_second;
    plan.require_countable(file);
    if (!scene.probes.empty() || !scene.recorded.empty()) plan.probe_step = scene.probe_step;
    if (const std::optional<Real> step = scene.world.settings().step_size)
        expect_countable(file, "steps of settings.step_size per frame or sample of the probes",
                         plan.longest_call() / *step, "increase settings.step_size (--step), or shorten the frames");
    if (!(plan.probe_step > 0)) return plan;
    const double samples = std::min(plan.frame_step, plan.seconds) / scene.probe_step;
    expect_countable(file, "samples of the probes per frame", samples, "increase probe_step");
    const bool in_whole_frames = plan.even() && plan.frame_step <= plan.seconds;
    plan.samples = static_cast<int>(in_whole_frames ? std::lround(samples) : std::lround(std::ceil(samples)) + 1);
    return plan;
}

}  // namespace skerry
