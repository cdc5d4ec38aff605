// Disturbance of a measurement by other programs, and statistics that filter it out.
#pragma once

#include <vector>

namespace skerry::profiling {

/// Measures the number of cores that other programs, and other guests of the host, have used since its construction.
/// cores() returns -1 where the system does not report this.
class OthersWatch {
public:
    OthersWatch();
    double cores() const;

private:
    double all_, own_, wall_;  // [s]
};

/// Sleeps until other programs have left the cores alone for a moment, but for no longer than `at_most` [s]. Returns
/// the time that it slept [s].
double wait_for_quiet(double at_most);

/// Runs of the same steps on each number of threads, one right after the other.
struct Round {
    double others = 0;                       // cores used by other programs
    std::vector<std::vector<double>> steps;  // time of each step, by number of threads [s]
};

/// Returns the third of the rounds that other programs disturbed least.
std::vector<Round> least_disturbed(std::vector<Round> rounds);

/// The 20th percentile: the value that a fifth of the values does not exceed.
double lower_fifth(std::vector<double> values);

/// Sum over all steps of the lower fifth (lower_fifth) of their times over the rounds, for the number of threads at
/// index `stage` [s]. A step of a millisecond that is disturbed in most rounds, but not in all, thus counts as
/// undisturbed. Throws std::runtime_error if the rounds have different numbers of steps.
double undisturbed_sum(const std::vector<Round>& rounds, std::size_t stage);

}  // namespace skerry::profiling
