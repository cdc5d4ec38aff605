// Fills a surface with tetrahedra by running the program skerry-fill.
#pragma once

#include <functional>

#include "skerry/mesh.h"

namespace skerry {

/// Throws SceneError with installation instructions unless skerry-fill is in the folder of this program.
void require_fill();

/// Fills a closed surface with tetrahedra whose largest edge is about `largest_edge` [m]. The surface is kept bitwise.
/// `wait` is called about 50 times a second. Returns a mesh without tetrahedra if skerry-fill fails.
Mesh fill_surface(const SurfaceMesh& surface, Real largest_edge, const std::function<void()>& wait);

}  // namespace skerry
