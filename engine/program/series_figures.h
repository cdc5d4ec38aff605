// Figures of the time series of the probes of a run: a few numbers for each time series, for the table of a sweep.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "skerry/recorder.h"

namespace skerry {

/// Figures of each column of the probes: value at the end, and smallest, largest and mean value of all samples. Samples
/// without a value, such as forces before the first step, do not count. The mean weights each sample by the time since
/// the previous one.
class SeriesFigures {
public:
    /// Takes the first sample.
    SeriesFigures(World& world, const std::vector<RecordedProbe>& probes);
    /// Must be called after every call of World::advance.
    void sample(const World& world);
    /// Returns the figures by name, for example grip.force_x_max_N. A figure without any sample is NaN.
    std::vector<std::pair<std::string, double>> all() const;

private:
    Recorder recorder_;
};

}  // namespace skerry
