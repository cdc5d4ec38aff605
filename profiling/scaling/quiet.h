// How much other programs disturb a measurement, and what is left when they are taken out of it.
#pragma once

#include <vector>

namespace skerry::profiling {

/// Cores that other programs, and other guests of the host, took since it was made; -1 where the system does not tell.
class OthersWatch {
public:
    OthersWatch();
    double cores() const;

private:
    double all_, own_, wall_;  // s
};

/// Sleeps until other programs have left the cores alone for a moment, at most so long, s. Returns for how long it
/// slept.
double wait_for_quiet(double at_most);

/// Runs of the same steps on each number of threads, one right after the other.
struct Round {
    double others = 0;                       // cores that other programs took
    std::vector<std::vector<double>> steps;  // s, by number of threads
};

/// The third that other programs disturbed least.
std::vector<Round> least_disturbed(std::vector<Round> rounds);

/// What a fifth of the values does not exceed.
double lower_fifth(std::vector<double> values);

/// s, of all steps on the number of threads at this place, each with the lower fifth of the rounds: a step of a
/// millisecond that is disturbed in most rounds, but not in all, is seen undisturbed. Throws std::runtime_error when
/// the rounds have different numbers of steps.
double undisturbed_sum(const std::vector<Round>& rounds, std::size_t place);

}  // namespace skerry::profiling
