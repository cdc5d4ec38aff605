// Agreement of runs whose starts differ by a tiny perturbation (docs/methods/study.md 3).
#pragma once

#include <span>
#include <vector>

#include "skerry/study.h"

namespace skerry {

/// Two runs agree while their difference is at most this share of the scale of the column. Contacts of faces can
/// increase a perturbation at once to 1e-4 of the scale, after which it does not grow.
inline constexpr Real agreement_share = 1e-3;

/// An unperturbed run, and runs whose starts differ from its start by a perturbation. All have the same columns and
/// times.
struct PerturbedRuns {
    const StudyRun* run = nullptr;
    std::vector<const StudyRun*> perturbed{};
};

/// Largest difference between a perturbed run and the unperturbed run in the first row, which is the perturbation
/// itself. 0 for columns without a value before the first step.
Real first_difference(const PerturbedRuns& runs, std::size_t column);

/// Returns the last time at which all runs agree on a column, infinity if they agree to the end [s].
Real agree_until(const PerturbedRuns& runs, std::size_t column, Real scale);

/// Returns the rate of exponential growth of the largest difference, relative to the scale, among all columns with the
/// unit of length [1/s]. The rate is fitted to the interval in which the difference grows from rounding errors to a
/// hundredth. 0 if it grows less than a hundredfold.
Real growth_rate(const PerturbedRuns& runs, std::span<const Real> scales);

}  // namespace skerry
