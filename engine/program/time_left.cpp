#include "engine/program/time_left.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skerry {

void TimeLeft::reach(double wall, double time) {
    // Smallest ratio of the wall time of a stored sample to that of the sample two places before it; other samples are
    // dropped. The smaller the ratio, the more accurately estimate() finds the sample at half of the wall time.
    constexpr double growth = 1.05;
    const std::size_t count = samples_.size();
    if (count > 1 && wall < growth * samples_[count - 2].wall)
        samples_.back() = {wall, time};
    else
        samples_.push_back({wall, time});
}

double TimeLeft::estimate_from(const Sample& before) const {
    const Sample& now = samples_.back();
    const double simulated_time_left = std::max(0.0, end_ - now.time);
    return now.time > before.time ? simulated_time_left * (now.wall - before.wall) / (now.time - before.time)
                                  : std::numeric_limits<double>::infinity();
}

double TimeLeft::estimate() const {
    const auto half = std::partition_point(samples_.begin(), samples_.end() - 1, [&](const Sample& sample) {
        return sample.wall <= samples_.back().wall / 2;
    });
    const double mean = estimate_from(samples_.front());
    const double recent = estimate_from(half == samples_.begin() ? *half : *(half - 1));
    return std::isfinite(recent) ? std::sqrt(mean * recent) : mean;
}

}  // namespace skerry
