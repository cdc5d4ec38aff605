// Checks that the boundary of a mesh is a closed manifold.
#pragma once

#include <span>
#include <string>

#include "systems/collision/build_surface.h"

namespace skerry::mesh {

/// Describes the first violation of a closed manifold, with the node numbers of the mesh, and counts such violations:
/// "node 3, at which parts of the boundary meet without a common edge (2 such meetings in total)". Returns an empty
/// text if there is no violation. In a closed manifold each edge has two triangles, and the triangles around each node
/// form one ring.
std::string manifold_fault(std::span<const BoundaryTriangle> boundary);

}  // namespace skerry::mesh
