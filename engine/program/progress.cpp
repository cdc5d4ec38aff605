#include "engine/program/progress.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/output/number_text.h"
#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

constexpr double refresh_interval = 0.1;  // time between two updates of the bar [s]
// wall time of the first line, and shortest time between two lines [s]; within a shorter time the time left cannot be
// estimated
constexpr double first_line = 1;
constexpr double longest_silence = 600;       // longest time between two lines [s]
constexpr int bar_width = 24;                 // [characters]
constexpr std::size_t large_scene = 100'000;  // number of tetrahedra from which the set-up of a scene is reported

double seconds_of(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double fraction_of(double time, double seconds) {
    return time < seconds ? time / seconds : 1;
}

}  // namespace

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

std::string bar_text(double fraction) {
    const int filled = static_cast<int>(fraction * bar_width);
    return "[" + std::string(static_cast<std::size_t>(filled), '#') +
           std::string(static_cast<std::size_t>(bar_width - filled), '.') + "]";
}

void clear_bar() {
    if (isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
}

Progress::Progress(bool visible, double seconds, double steps, double step, double begin)
    : visible_(visible),
      bar_(visible && isatty(STDERR_FILENO) != 0),
      seconds_(seconds),
      steps_(steps),
      step_(step),
      time_left_(seconds, begin),
      next_(bar_ ? 0 : first_line) {}

void Progress::begin() {
    begun_ = true;
    std::fprintf(stderr, "skerry: %s s to simulate, about %s steps of %s\n", short_text(seconds_).c_str(),
                 count_text(steps_).c_str(), with_unit(step_, "s").c_str());
}

Progress::~Progress() {
    if (bar_ && begun_) clear_bar();
}

void Progress::show(double time, std::uint64_t steps) {
    if (!visible_) return;
    const double wall = watch_.seconds();
    time_left_.reach(wall, time);
    if (wall < next_) return;
    if (!begun_) begin();
    if (bar_)
        show_bar(wall, time);
    else
        show_line(wall, time, steps);
    next_ = bar_ ? wall + refresh_interval : wall + std::clamp(wall, first_line, longest_silence);
    std::fflush(stderr);
}

void Progress::show_bar(double wall, double time) {
    const double fraction = fraction_of(time, seconds_);
    std::fprintf(stderr, "\r\033[K%s %s %%  %s of %s s", bar_text(fraction).c_str(), short_text(100 * fraction).c_str(),
                 short_text(time).c_str(), short_text(seconds_).c_str());
    if (const std::string remaining = remaining_text(); !remaining.empty())
        std::fprintf(stderr, "  %s x real time  %s left", short_text(time / wall).c_str(), remaining.c_str());
}

void Progress::show_line(double wall, double time, std::uint64_t steps) {
    const double fraction = fraction_of(time, seconds_);
    std::fprintf(stderr, "skerry: after %s: %s of %s s (%s %%), %s steps", duration_text(wall).c_str(),
                 short_text(time).c_str(), short_text(seconds_).c_str(), short_text(100 * fraction).c_str(),
                 grouped(steps).c_str());
    if (const std::string remaining = remaining_text(); !remaining.empty())
        std::fprintf(stderr, "; about %s left", remaining.c_str());
    std::fputc('\n', stderr);
}

std::string Progress::remaining_text() const {
    const double seconds = time_left_.estimate();
    return std::isfinite(seconds) ? duration_text(seconds) : "";
}

SetupProgress::SetupProgress(bool visible, const ScenePlan& plan) : visible_(visible), bodies_(plan.bodies.size()) {
    std::size_t tetrahedra = 0;
    for (const BodyPlan& body : plan.bodies) tetrahedra += plan.meshes[body.mesh].tetrahedra.size();
    visible_ = visible && tetrahedra >= large_scene;
    if (visible_)
        std::fprintf(stderr, "skerry: set-up of %s tetrahedra: adding %s\n", grouped(tetrahedra).c_str(),
                     bodies_ == 1 ? "the body" : (grouped(bodies_) + " bodies").c_str());
}

void SetupProgress::added(std::size_t bodies) {
    if (!visible_ || bodies == bodies_ || watch_.seconds() < last_ + first_line) return;
    last_ = watch_.seconds();
    std::fprintf(stderr, "skerry: set-up after %s: %s of %s bodies\n", duration_text(last_).c_str(),
                 grouped(bodies).c_str(), grouped(bodies_).c_str());
}

void SetupProgress::begin(const char* work) {
    if (!visible_) return;
    last_ = watch_.seconds();
    std::fprintf(stderr, "skerry: set-up after %s: %s\n", duration_text(last_).c_str(), work);
}

ActivityLine::ActivityLine(bool visible) : visible_(visible), terminal_(isatty(STDERR_FILENO) != 0) {}

ActivityLine::~ActivityLine() {
    if (visible_) clear_bar();
}

void ActivityLine::show(const std::string& activity) {
    const double wall = watch_.seconds();
    if (!visible_ || (!terminal_ && wall < next_)) return;
    if (terminal_)
        std::fprintf(stderr, "\r\033[K%s, %.1f s", activity.c_str(), wall);
    else
        std::fprintf(stderr, "skerry: after %s: %s\n", duration_text(wall).c_str(), activity.c_str());
    next_ = 2 * wall;
    std::fflush(stderr);
}

ScenePlan plan_with_progress(const std::filesystem::path& file, const SceneOverrides& overrides, bool visible) {
    ActivityLine line(visible);
    return plan_scene(file, overrides, [&](const std::string& activity) { line.show(activity); });
}

}  // namespace skerry
