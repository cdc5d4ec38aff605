// Copies the state of a world into a frame of output.
#pragma once

#include <vector>

#include "engine/output/frame.h"
#include "skerry/world.h"

namespace skerry {

/// Values of the bodies in a frame. Each value of this enum includes the data of the values above it, and takes longer
/// to collect.
enum class FrameContent {
    motion,       // positions, velocities, contacts and lines
    node_fields,  // stress and strain by node
    mesh_error,   // error of the mesh by node, and the energy of the world
    cell_values,  // values by cell
};
/// Values that the content does not include are left empty.
Frame collect_frame(const World& world, FrameContent content = FrameContent::cell_values);
/// Joints, ties, cables and springs, in this order.
std::vector<LineFrame> collect_lines(const World& world);

}  // namespace skerry
