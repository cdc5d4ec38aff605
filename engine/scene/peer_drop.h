// Drop files: one mesh, many placements and a box to fall into, as used to compare engines.
#pragma once

#include "engine/scene/scene_file.h"

namespace skerry {

/// Whether a document is a drop file rather than a scene: it has "bucket" and "mesh" at its top.
bool is_drop_file(const Json& json);

/// Adds the bodies, the floor and the four walls of a drop file to a scene. A node of body i is position_i + rotation_rows_i times the node of
/// the mesh; the walls are the planes x = +-wall_x and z = +-wall_z, the floor is y = floor_y.
void read_drop_file(const Json& json, const Place& place, SceneFile& scene);

}  // namespace skerry
