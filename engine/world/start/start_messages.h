// Messages about overlaps at the start, and their refusal.
#pragma once

#include <cstddef>
#include <string>

#include "skerry/report.h"

namespace skerry {

/// Throws SceneError. It names the partners of an overlap, the number of other overlaps, and the reason `why` it stays.
[[noreturn]] void refuse_overlap(const StartOverlap& overlap, std::size_t others, const std::string& why);

}  // namespace skerry
