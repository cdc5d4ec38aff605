// Estimate of the time that a run still needs.
#pragma once

#include <vector>

namespace skerry {

/// Estimates the wall time that is left in a run from its pace so far. Because the pace changes when bodies meet or
/// come to rest, the estimate is the geometric mean of two: from the mean pace of the run, and from the pace in the
/// last half of the wall time.
class TimeLeft {
public:
    /// `end`: simulated time at which the run ends [s]. `begin`: simulated time at which it begins, above 0 for a
    /// resumed run [s].
    explicit TimeLeft(double end, double begin = 0) : end_(end), samples_{{0, begin}} {}

    /// Records that the simulation has reached the simulated time `time` after `wall` seconds of wall time. Neither may
    /// decrease.
    void reach(double wall, double time);
    /// Returns the wall time that is left [s]; infinite if the simulation has not advanced.
    double estimate() const;

private:
    struct Sample {
        double wall, time;  // wall time, simulated time [s]
    };

    double estimate_from(const Sample& before) const;

    double end_;
    // The last entry is the present state. Among the other entries, the wall time of each is at least 1.05 times that
    // of the entry two places before it, so that a long run needs few entries.
    std::vector<Sample> samples_;
};

}  // namespace skerry
