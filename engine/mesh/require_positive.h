// Checks a mesh or a surface from which a body will be made.
#pragma once

#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Throws SceneError unless the mesh has tetrahedra, all nodes are finite, and every tetrahedron has four different
/// existing nodes and a positive rest volume. The message contains `what` (the name of the file or body), the first bad
/// tetrahedron and the number of bad tetrahedra.
void require_positive(const Mesh& mesh, const std::string& what);

/// Throws SceneError unless the surface is closed and all of its shells enclose volume. A shell that is inside out must
/// lie in the bounding box of another shell, in which it bounds a void. Shells may cross each other only if
/// `may_cross`. Node numbers must be valid.
void require_shells(const SurfaceMesh& surface, const std::string& what, bool may_cross);

}  // namespace skerry::mesh
