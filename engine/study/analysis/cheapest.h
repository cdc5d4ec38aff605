// The cheapest settings for a wanted error (docs/methods/study.md 4).
#pragma once

#include <optional>
#include <span>

#include "engine/study/analysis/measure.h"

namespace skerry {

/// Returns the cheapest settings with which the predicted relative errors of all known quantities are at most
/// `wanted_error`. The settings to choose from are all combinations of the meshes, kinds of elements, steps and
/// tolerances that were run, and up to two finer meshes.
///
/// If no settings reach `wanted_error`, returns the cheapest of those whose error exceeds the smallest error by at most
/// 10 %. Empty if no quantity has a known error.
std::optional<CheapestSettings> cheapest_settings(const StudyFamily& family,
                                                  std::span<const MeasuredQuantity> quantities, double wanted_error);

}  // namespace skerry
