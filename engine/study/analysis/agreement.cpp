#include "engine/study/analysis/agreement.h"

#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

/// Largest difference between a perturbed run and the unperturbed run in one row of a column.
Real difference_at(const PerturbedRuns& runs, std::size_t column, std::size_t row) {
    Real largest = 0;
    for (const StudyRun* perturbed : runs.perturbed) {
        const Real difference =
            std::abs(perturbed->columns[column].values[row] - runs.run->columns[column].values[row]);
        if (difference > largest) largest = difference;  // unknown values do not count
    }
    return largest;
}

}  // namespace

Real first_difference(const PerturbedRuns& runs, std::size_t column) {
    return runs.run->time.empty() ? 0 : difference_at(runs, column, 0);
}

Real agree_until(const PerturbedRuns& runs, std::size_t column, Real scale) {
    for (std::size_t row = 0; row < runs.run->time.size(); ++row)
        if (difference_at(runs, column, row) > agreement_share * scale) return runs.run->time[row > 0 ? row - 1 : 0];
    return infinity;
}

Real growth_rate(const PerturbedRuns& runs, std::span<const Real> scales) {
    constexpr Real rounding = 1e-14, grown = 1e-2, least_growth = 100;
    Real count = 0, sum_t = 0, sum_y = 0, sum_tt = 0, sum_ty = 0, first = 0, largest = 0;
    for (std::size_t row = 0; row < runs.run->time.size() && largest < grown; ++row) {
        Real difference = 0;
        for (std::size_t column = 0; column < scales.size(); ++column)
            if (runs.run->columns[column].what.unit == "m" && scales[column] > 0)
                difference = std::max(difference, difference_at(runs, column, row) / scales[column]);
        if (difference < rounding) continue;
        if (first == 0) first = difference;
        largest = std::max(largest, difference);
        const Real t = runs.run->time[row], y = std::log(difference);
        count += 1, sum_t += t, sum_y += y, sum_tt += t * t, sum_ty += t * y;
    }
    const Real spread = count * sum_tt - sum_t * sum_t;
    if (!(spread > 0) || largest < least_growth * first) return 0;
    return std::max(Real{0}, (count * sum_ty - sum_t * sum_y) / spread);
}

}  // namespace skerry
