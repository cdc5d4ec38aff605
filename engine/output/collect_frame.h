// Copies the state of a world into a frame of output.
#pragma once

#include "engine/output/frame.h"
#include "skerry/world.h"

namespace skerry {

Frame collect_frame(const World& world);

}  // namespace skerry
