// What is said of overlaps at the start, and how they are refused.
#pragma once

#include <cstddef>
#include <string>

#include "skerry/report.h"

namespace skerry {

/// Throws SceneError: names those of an overlap, says how many others there are, and why they stay.
[[noreturn]] void refuse_overlap(const StartOverlap& overlap, std::size_t others, const std::string& why);

}  // namespace skerry
