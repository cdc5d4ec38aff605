// Fills a surface with tetrahedra by running the separate program skerry-fill.
#pragma once

#include <functional>

#include "skerry/mesh.h"

namespace skerry {

/// Throws SceneError with installation instructions if the folder of this program does not contain skerry-fill.
void require_fill();

/// Fills a closed surface with tetrahedra of edge length up to about `largest_edge` [m]. The surface is unchanged
/// bitwise. Meanwhile `wait` is called about 50 times a second. Returns a mesh without tetrahedra if skerry-fill fails.
Mesh fill_surface(const SurfaceMesh& surface, Real largest_edge, const std::function<void()>& wait);

}  // namespace skerry
