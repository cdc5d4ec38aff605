// Summary of one time series.
#pragma once

#include <span>

#include "components/types.h"

namespace skerry {

/// Last, smallest, largest and mean value of a time series. For the mean, each value is weighted with the time since
/// the previous row. Values that are not finite are ignored. If no value is finite, all four results are NaN.
struct SeriesSummary {
    Real end, least, most, mean;
};

/// `time`: times of the rows [s], as many as there are `values`.
SeriesSummary summary_of_series(std::span<const Real> time, std::span<const Real> values);

}  // namespace skerry
