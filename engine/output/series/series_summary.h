// Summary of one time series.
#pragma once

#include <span>

#include "components/types.h"

namespace skerry {

/// Last, smallest, largest and mean value of a time series. In the mean each value has the weight of the time since the
/// previous row. Values that are not finite do not count; without any value all are NaN.
struct SeriesSummary {
    Real end, least, most, mean;
};

/// `time`: times of the rows [s], as many as there are `values`.
SeriesSummary summary_of_series(std::span<const Real> time, std::span<const Real> values);

}  // namespace skerry
