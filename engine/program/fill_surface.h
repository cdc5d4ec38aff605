// Tetrahedra inside a surface, by the program skerry-fill.
#pragma once

#include <functional>

#include "skerry/mesh.h"

namespace skerry {

/// Throws SceneError that says what to install unless skerry-fill is beside this program.
void require_fill();

/// Tetrahedra of about the given largest edge (m) inside a closed surface, which stays as it is to the last bit. `wait`
/// is called about ten times a second. Without tetrahedra when skerry-fill finds none.
Mesh fill_surface(const SurfaceMesh& surface, Real largest_edge, const std::function<void()>& wait);

}  // namespace skerry
