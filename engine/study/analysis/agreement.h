// Agreement of runs whose starts differ by a tiny perturbation (docs/methods/study.md 3).
#pragma once

#include <span>
#include <vector>

#include "skerry/study.h"

namespace skerry {

/// Largest difference between two runs that agree on a column, as a share of the column's scale (column_scales()). It
/// must exceed 1e-4: contacts between faces can suddenly increase a perturbation to 1e-4 of the scale, but do not let
/// it grow further.
inline constexpr Real agreement_share = 1e-3;

/// An unperturbed run, and runs whose starts differ from its start by a perturbation. All have the same columns and
/// times.
struct PerturbedRuns {
    const StudyRun* run = nullptr;
    std::vector<const StudyRun*> perturbed{};
};

/// Largest difference between a perturbed run and the unperturbed run in the first row: the perturbation itself, or its
/// immediate effect. 0 for columns without a value before the first step.
Real first_difference(const PerturbedRuns& runs, std::size_t column);

/// Returns the time up to which all runs agree on a column [s]; infinity if they agree to the end.
Real agree_until(const PerturbedRuns& runs, std::size_t column, Real scale);

/// Returns the rate r at which the difference between perturbed and unperturbed runs grows, as exp(r t) [1/s]. Returns
/// 0 if the difference grows less than a hundredfold.
///
/// The difference at the time t is the largest one of all columns with the unit m, each divided by the scale of its
/// column. The rate is fitted to the rows from the first with a difference of at least 1e-14 up to the first with at
/// least 0.01.
Real growth_rate(const PerturbedRuns& runs, std::span<const Real> scales);

}  // namespace skerry
