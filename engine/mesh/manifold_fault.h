// What keeps the boundary of a mesh from being a closed manifold.
#pragma once

#include <span>
#include <string>

#include "systems/collision/build_surface.h"

namespace skerry::mesh {

/// Each edge has two triangles, and those around each node follow each other in one ring. Says where it is not so, in
/// the nodes of the mesh: "node 3 joins parts that share no edge there"; empty where it is.
std::string manifold_fault(std::span<const BoundaryTriangle> boundary);

}  // namespace skerry::mesh
