// The error message for an overlap at the start that is refused.
#pragma once

#include <cstddef>
#include <string>

#include "skerry/report.h"

namespace skerry {

/// Throws SceneError. The message names the partners of the overlap, the number of other overlaps, and `reason`, the
/// reason why this overlap is not resolved.
[[noreturn]] void refuse_overlap(const StartOverlap& overlap, std::size_t other_count, const std::string& reason);

}  // namespace skerry
