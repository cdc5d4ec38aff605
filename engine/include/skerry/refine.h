// Uniform subdivision of meshes.
#pragma once

#include "skerry/mesh.h"

#pragma GCC visibility push(default)
namespace skerry::mesh {

/// Divides each tetrahedron into eight by new nodes at the midpoints of its edges: one part at each corner, and four
/// around the shortest diagonal between midpoints. Repeated subdivision leaves the worst quality of the tetrahedra
/// (MeshReport::min_quality) at about its value after the first one. Triangles of a mesh without tetrahedra are divided
/// into four.
///
/// The surface keeps its shape, also where the triangles approximate a curved one. The new nodes follow the present
/// ones, which keep their numbers; in Mesh::file_number they get numbers after the largest one. Parts have the labels
/// and vectors of the whole, and replace it in sets of faces and tetrahedra. A set of nodes gets the midpoints of
/// - all edges of faces whose three nodes are in the set,
/// - edges with both ends in the set, if one of the ends belongs to no such face, as on a curve.
///
/// The running time is proportional to the number of tetrahedra. Throws SceneError if the mesh is invalid, or if the
/// numbers of the refined mesh exceed 32-bit indices.
Mesh refine(Mesh mesh);

}  // namespace skerry::mesh
#pragma GCC visibility pop
