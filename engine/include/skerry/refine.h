// Uniform subdivision of meshes.
#pragma once

#include "skerry/mesh.h"

#pragma GCC visibility push(default)
namespace skerry::mesh {

/// Divides each tetrahedron into eight by new nodes at the midpoints of its edges: one part at each corner, and four
/// around the shortest diagonal between midpoints. Triangles of a mesh without tetrahedra are divided into four.
///
/// - Quality: the first subdivision can lower the worst quality of the tetrahedra (MeshReport::min_quality); further
///   ones hardly change it.
/// - Shape: new nodes stay on the flat triangles of the surface, even if these approximate a curved surface.
/// - Numbers: the present nodes keep their numbers, and the new nodes are appended. In Mesh::file_number new nodes get
///   numbers after the largest one.
/// - Labels, vectors and sets: the parts of a tetrahedron have its label and vectors. In sets, the parts of a face or
///   tetrahedron replace it.
/// A set of nodes can stand for faces or for curves of the surface. It gets two kinds of midpoints, so that it also
/// contains the new nodes of these faces and curves:
/// - midpoints of the edges of each face whose three nodes are all in the set,
/// - midpoints of edges with both ends in the set, unless both ends belong to such faces.
/// The running time is proportional to the number of tetrahedra. Throws SceneError if the mesh is invalid, or if the
/// numbers of the refined mesh exceed 32-bit indices.
Mesh refine(Mesh mesh);

}  // namespace skerry::mesh
#pragma GCC visibility pop
