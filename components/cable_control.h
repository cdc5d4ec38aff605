// Handles of cables, and the quantities of a cable that can be prescribed.
#pragma once

#include <cstdint>

#include "components/handle.h"

namespace skerry {

using CableHandle = Handle<struct CableTag>;

/// Quantity of a cable that its keys prescribe: the tension of its first segment [N], its greatest length [m], or the
/// rate of its greatest length [m/s].
enum class CableControl : std::uint8_t { tension, length, rate };

}  // namespace skerry
