// Shared tools of the profiling programs: clocks, medians, and one rule for repeated timing.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

namespace skerry::profiling {

/// CPU time of the calling thread, or of the whole process with CLOCK_PROCESS_CPUTIME_ID [s].
inline double cpu_seconds(clockid_t clock = CLOCK_THREAD_CPUTIME_ID) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The upper median; 0 if there are no values.
inline double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Runs of at least this length are timed once, by the CPU time of their thread, which other programs do not lengthen.
/// Shorter ones are repeated and timed by the wall clock, which costs less to read. The median drops interrupted runs.
inline constexpr double long_run = 5e-3;  // [s]
/// Total time for the repeats of a short run [s]. A program may set less to finish sooner.
inline double repeat_budget = 20e-3;

/// Time of `run` by the rule of long_run [s]. `prepare` is called before each run and is not timed. solve_problem times
/// itself in the same way.
template <class Prepare, class Run>
double timed(Prepare&& prepare, Run&& run) {
    std::vector<double> seconds;
    double sum = 0;
    do {
        prepare();
        const bool first = seconds.empty();
        const double cpu = first ? cpu_seconds() : 0;
        const double start = wall_seconds();
        run();
        const double wall = wall_seconds() - start;
        if (first && wall >= long_run) return cpu_seconds() - cpu;
        seconds.push_back(wall);
        sum += wall;
    } while (sum < repeat_budget && seconds.size() < 1001);
    return median(std::move(seconds));
}

}  // namespace skerry::profiling
