// Triangles of a surface that cross or overlap other triangles, and thin walls.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Reports pairs of triangles that pass through each other or overlap in a plane. `distance`: overlap that counts as
/// rounding error [m].
void find_crossings(SurfaceReport& report, Real distance);

/// Reports places of closed shells with a wall thinner than half the mean edge. The thickness is measured at up to 1000
/// triangles with rays along the inner normal to the next triangle.
void find_thin_walls(SurfaceReport& report);

}  // namespace skerry::mesh
