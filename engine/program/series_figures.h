// Figures of the time series of the probes of a run, for the table of a sweep.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "skerry/recorder.h"

namespace skerry {

/// Returns the figures of each column of a recorder by name, for example grip.force_x_max_N: value at the end, smallest,
/// largest and mean value. Samples without a value, such as forces before the first step, do not count.
std::vector<std::pair<std::string, double>> named_figures(const Recorder& recorder);

}  // namespace skerry
