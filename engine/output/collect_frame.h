// A frame of output from a world.
#pragma once

#include <cstdint>

#include "engine/output/frame.h"
#include "skerry/world.h"

namespace skerry {

/// Collects frames of one run. Remembers only when the last one was, because contacts carry impulses and a force needs
/// the step size: it is the mean of the steps since the frame before, which is exact when one call of advance lies
/// between two frames.
class FrameCollector {
public:
    Frame collect(const World& world);

private:
    Real time_prev_ = 0;  // s
    Real step_size_ = 0;  // s
    std::uint64_t steps_prev_ = 0;
};

}  // namespace skerry
