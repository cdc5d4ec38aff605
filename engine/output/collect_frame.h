// Copies the state of a world into a frame (the data of one point in time) for output.
#pragma once

#include <vector>

#include "engine/output/frame.h"
#include "skerry/world.h"

namespace skerry {

/// Data that a frame contains. Each enumerator includes the data of those above it, and takes longer to collect.
enum class FrameContent {
    motion,       // positions, velocities, contacts and lines
    node_fields,  // stress and strain by node
    mesh_error,   // error of the mesh by node, and the energy of the world
    cell_values,  // stress, strain, plastic strain, material and fibre values by cell (tetrahedron or triangle)
};
/// Returns the present state of the world. Data that `content` does not include are left empty.
Frame collect_frame(const World& world, FrameContent content = FrameContent::cell_values);
/// Lines that show joints, ties, cables and springs, in this order.
std::vector<LineFrame> collect_lines(const World& world);

}  // namespace skerry
