#include "engine/program/course.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "skerry/error.h"

namespace skerry {

long Course::frames() const {
    return std::max(1L, static_cast<long>(std::ceil(seconds / frame_step - slack)));
}

double Course::length_of(long frame) const {
    return std::min(frame_step, seconds - static_cast<double>(frame) * frame_step);
}

double Course::longest_step(const World& world) const {
    const Real stable = world.stable_step();
    return std::min({frame_step / samples, seconds / samples, stable, world.settings().step_size.value_or(stable)});
}

double Course::steps(const World& world) const {
    const double sample = std::min(frame_step, seconds) / samples;
    return std::max(0.0, seconds - world.time()) / sample * std::ceil(sample / longest_step(world));
}

bool cut_short(const Course& course, long frame, double planned) {
    const double before = Course{planned, course.frame_step, course.samples}.length_of(frame);
    const bool within = before > Course::slack * course.frame_step && before < (1 - Course::slack) * course.frame_step;
    return within && before != course.length_of(frame);
}

namespace {

void expect_countable(const RunOptions& options, const char* field, double count, const char* hint) {
    constexpr double most = 1e9;
    if (count <= most) return;
    char found[64];
    std::snprintf(found, sizeof found, "%g of them", count);
    Complaint{.file = options.scene.string(),
              .object = "run",
              .field = field,
              .found = found,
              .expected = "at most 1e9",
              .hint = hint}
        .raise();
}

void expect_countable_frames(const RunOptions& options, const Course& course) {
    expect_countable(options, "frames", course.seconds / course.frame_step,
                     "seconds times frames per second: seconds, frame_step");
}

}  // namespace

Course course_of(const Scene& scene, const RunOptions& options) {
    Course course{options.seconds.value_or(scene.seconds), scene.frame_step, 1};
    if (options.frames_per_second) course.frame_step = 1 / *options.frames_per_second;
    expect_countable_frames(options, course);
    if (scene.probes.empty() && scene.recorded.empty()) return course;
    const double samples = std::min(course.frame_step, course.seconds) / scene.probe_step;
    expect_countable(options, "samples of the probes in a frame", samples, "probe_step");
    course.samples = std::max(1, static_cast<int>(std::lround(samples)));
    return course;
}

Course course_of(const RunOptions& options, const RunMemory& memory, double time) {
    const Course course{options.seconds.value_or(memory.seconds), memory.frame_step, memory.samples};
    expect_countable_frames(options, course);
    if (course.seconds > time + Course::slack * course.frame_step) return course;
    char found[64], expected[64];
    std::snprintf(found, sizeof found, "a run that has come to %g s", time);
    std::snprintf(expected, sizeof expected, "one that is not at its end, %g s", course.seconds);
    Complaint{.file = options.restart.string(),
              .object = "--restart",
              .field = {},
              .found = found,
              .expected = expected,
              .hint = "--seconds asks for more"}
        .raise();
}

}  // namespace skerry
