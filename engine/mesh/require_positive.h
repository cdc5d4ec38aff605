// Checks a mesh from which a body will be made.
#pragma once

#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Throws SceneError unless the mesh has tetrahedra, all nodes are finite, and every tetrahedron has four different
/// existing nodes and a positive rest volume. The message contains `name` (the name of the file or body), the first bad
/// tetrahedron and the number of bad tetrahedra.
void require_positive(const Mesh& mesh, const std::string& name);

}  // namespace skerry::mesh
