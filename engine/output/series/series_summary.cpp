#include "engine/output/series/series_summary.h"

#include <cmath>
#include <limits>

namespace skerry {

SeriesSummary summary_of_series(std::span<const Real> time, std::span<const Real> values) {
    constexpr Real none = std::numeric_limits<Real>::quiet_NaN();
    SeriesSummary found{none, none, none, none};
    Real sum = 0, seconds = 0;
    for (std::size_t row = 0; row < values.size(); ++row) {
        const Real value = values[row];
        if (!std::isfinite(value)) continue;
        found.end = value;
        if (!(found.least <= value)) found.least = value;
        if (!(found.most >= value)) found.most = value;
        const Real since = row > 0 ? time[row] - time[row - 1] : 0;
        sum += since * value;
        seconds += since;
    }
    found.mean = seconds > 0 ? sum / seconds : found.end;
    return found;
}

}  // namespace skerry
