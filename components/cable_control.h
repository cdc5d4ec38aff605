// Handles of cables, and the quantities of a cable that can be prescribed.
#pragma once

#include <cstdint>

#include "components/handle.h"

namespace skerry {

using CableHandle = Handle<struct CableTag>;  // refers to a cable of a world

/// Quantity of a cable that the user prescribes over time.
enum class CableControl : std::uint8_t {
    tension,  // tension of the first segment [N]
    length,   // upper limit of the length; a shorter cable is slack [m]
    rate,     // rate of the upper limit of the length; a negative rate draws the cable in [m/s]
};

}  // namespace skerry
