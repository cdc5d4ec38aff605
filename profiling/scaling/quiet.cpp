#include "profiling/scaling/quiet.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "profiling/measure.h"

namespace skerry::profiling {

namespace {

/// Time that all cores together were at work; negative if it is unknown [s].
double busy_seconds() {
    std::ifstream file("/proc/stat");
    std::string cpu;
    double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, interrupts = 0, soft_interrupts = 0, stolen = 0;
    if (!(file >> cpu >> user >> nice >> system >> idle >> waiting >> interrupts >> soft_interrupts >> stolen))
        return -1;
    return (user + nice + system + interrupts + soft_interrupts + stolen) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

OthersWatch::OthersWatch() : all_(busy_seconds()), own_(cpu_seconds(CLOCK_PROCESS_CPUTIME_ID)), wall_(wall_seconds()) {}

double OthersWatch::cores() const {
    const double all = busy_seconds();
    if (all < 0) return -1;
    const double others = all - all_ - (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - own_);
    return std::max(0.0, others) / (wall_seconds() - wall_);
}

double wait_for_quiet(double at_most) {
    constexpr std::chrono::milliseconds moment{200};
    constexpr double little = 0.1;  // activity of the system itself, and one tick of its clock [cores]
    const double start = wall_seconds();
    while (wall_seconds() - start < at_most) {
        const OthersWatch others;
        std::this_thread::sleep_for(moment);
        if (others.cores() < little) break;
    }
    return wall_seconds() - start;
}

std::vector<Round> least_disturbed(std::vector<Round> rounds) {
    std::ranges::sort(rounds, {}, &Round::others);
    rounds.resize((rounds.size() + 2) / 3);
    return rounds;
}

double lower_fifth(std::vector<double> values) {
    const auto quantile = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 5);
    std::ranges::nth_element(values, quantile);
    return *quantile;
}

double undisturbed_sum(const std::vector<Round>& rounds, std::size_t stage) {
    const std::size_t count = rounds.front().steps[stage].size();
    for (const Round& round : rounds)
        if (round.steps[stage].size() != count) throw std::runtime_error("rounds differ in their steps");
    double sum = 0;
    std::vector<double> same(rounds.size());
    for (std::size_t step = 0; step < count; ++step) {
        std::ranges::transform(rounds, same.begin(), [=](const Round& round) { return round.steps[stage][step]; });
        sum += lower_fifth(same);
    }
    return sum;
}

}  // namespace skerry::profiling
