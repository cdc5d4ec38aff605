// Copies the state of a world into a frame of output.
#pragma once

#include <vector>

#include "engine/output/frame.h"
#include "skerry/world.h"

namespace skerry {

/// Without `stresses`, stresses and strains of the bodies are left empty, which saves most of the time.
Frame collect_frame(const World& world, bool stresses = true);
/// Joints, ties, cables and springs, in this order.
std::vector<LineFrame> collect_lines(const World& world);

}  // namespace skerry
