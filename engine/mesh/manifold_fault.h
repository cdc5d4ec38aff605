// Checks that the boundary of a mesh is a closed manifold.
#pragma once

#include <span>
#include <string>

#include "systems/collision/build_surface.h"

namespace skerry::mesh {

/// In a closed manifold each edge has two triangles, and the triangles around each node form one ring. Describes the
/// first violation with the mesh's node numbers: "node 3 joins parts that share no edge there". Empty if there is
/// none.
std::string manifold_fault(std::span<const BoundaryTriangle> boundary);

}  // namespace skerry::mesh
