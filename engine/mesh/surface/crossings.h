// Triangles of a surface that cross or overlap other triangles, and thin walls.
#pragma once

#include "skerry/surface_check.h"

namespace skerry::mesh {

/// Reports pairs of triangles that pass through each other, or that overlap in a common plane. `distance`: largest
/// overlap that counts as rounding error [m].
void find_crossings(SurfaceReport& report, Real distance);

/// Reports places of closed shells at which the wall is thinner than half the mean edge. The thickness is the length of
/// a ray from a triangle along its inner normal to the next triangle. It is measured at up to 1000 triangles.
void find_thin_walls(SurfaceReport& report);

}  // namespace skerry::mesh
