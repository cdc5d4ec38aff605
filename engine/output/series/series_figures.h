// Figures of one time series.
#pragma once

#include <span>

#include "components/types.h"

namespace skerry {

/// Last, smallest, largest and mean value of a time series. In the mean each value has the weight of the time since the
/// row before. Values that are not finite do not count; without any value all figures are NaN.
struct SeriesFigures {
    Real end, least, most, mean;
};

/// `time`: of the rows [s]; as many as `values`.
SeriesFigures series_figures(std::span<const Real> time, std::span<const Real> values);

}  // namespace skerry
