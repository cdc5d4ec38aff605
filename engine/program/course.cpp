#include "engine/program/course.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "skerry/error.h"

namespace skerry {

long Course::frames() const {
    constexpr double slack = 1e-9;  // of a frame: 0.1 s are six frames of 1/60 s, not seven
    return std::max(1L, static_cast<long>(std::ceil(seconds / frame_step - slack)));
}

double Course::length_of(long frame) const {
    return std::min(frame_step, seconds - static_cast<double>(frame) * frame_step);
}

double Course::longest_step(const World& world) const {
    const Real stable = world.stable_step() * world.settings().step_safety;
    return std::min({frame_step / samples, seconds / samples, stable, world.settings().step_size.value_or(stable)});
}

double Course::steps(const World& world) const {
    const double sample = std::min(frame_step, seconds) / samples;
    return seconds / sample * std::ceil(sample / longest_step(world));
}

Course course_of(const Scene& scene, const RunOptions& options) {
    Course course{options.seconds.value_or(scene.seconds), scene.frame_step, 1};
    if (options.frames_per_second) course.frame_step = 1 / *options.frames_per_second;
    const auto complain_of = [&](const char* field, double count, const char* hint) {
        char found[64];
        std::snprintf(found, sizeof found, "%g of them", count);
        Complaint{.file = options.scene.string(),
                  .object = "run",
                  .field = field,
                  .found = found,
                  .expected = "at most 1e9",
                  .hint = hint}
            .raise();
    };
    constexpr double most = 1e9;
    if (const double frames = course.seconds / course.frame_step; !(frames <= most))
        complain_of("frames", frames, "seconds times frames per second: seconds, frame_step");
    if (scene.probes.empty()) return course;
    const double samples = std::min(course.frame_step, course.seconds) / scene.probe_step;
    if (!(samples <= most)) complain_of("samples of the probes in a frame", samples, "probe_step");
    course.samples = std::max(1, static_cast<int>(std::lround(samples)));
    return course;
}

}  // namespace skerry
