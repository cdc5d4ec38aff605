// Estimate of the time that a run still needs.
#pragma once

#include <vector>

namespace skerry {

/// Estimates the wall time that is left in a run from its pace so far. The pace changes when bodies meet or come to
/// rest, so the estimate is the geometric mean of two: one by the mean pace, and one by the pace of the last half of
/// the wall time.
class TimeLeft {
public:
    /// `end`: time at which the simulation ends [s]. `begin`: time at which it begins; a resumed run begins later.
    explicit TimeLeft(double end, double begin = 0) : end_(end), samples_{{0, begin}} {}

    /// Notes that the simulation has reached `time` after `wall` seconds. Neither may decrease.
    void reach(double wall, double time);
    /// Returns the wall time that is left [s]; infinite if the simulation has not advanced.
    double estimate() const;

private:
    struct Sample {
        double wall, time;  // [s]
    };

    double left_at_pace_since(const Sample& before) const;

    double end_;
    std::vector<Sample> samples_;  // wall times grow by a constant factor; the last entry is the present
};

}  // namespace skerry
