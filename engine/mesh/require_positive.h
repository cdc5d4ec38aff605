// Checks a mesh that is to become a body.
#pragma once

#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Throws SceneError unless the mesh has tetrahedra, all nodes are finite, and every tetrahedron has four different
/// existing nodes and a positive rest volume. The message names `what` (the file or the body), the first bad
/// tetrahedron and the number of bad ones.
void require_positive(const Mesh& mesh, const std::string& what);

}  // namespace skerry::mesh
