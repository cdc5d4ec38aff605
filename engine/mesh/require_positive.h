// The check of a mesh that becomes a body.
#pragma once

#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Throws SceneError unless the mesh has tetrahedra, all nodes are finite, every tetrahedron names four different nodes
/// that exist and has a positive rest volume. The message names `what` (the file or the body), the first bad
/// tetrahedron and how many there are.
void require_positive(const Mesh& mesh, const std::string& what);

}  // namespace skerry::mesh
