// Collects a frame of output from a world.
#pragma once

#include "engine/output/frame.h"
#include "skerry/world.h"

namespace skerry {

Frame collect_frame(const World& world);

}  // namespace skerry
