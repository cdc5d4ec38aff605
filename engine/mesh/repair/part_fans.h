// Splits nodes of a mesh so that no tetrahedra are connected only by a node.
#pragma once

#include <cstddef>

#include "skerry/mesh.h"

namespace skerry::mesh {

struct PartedMesh {
    Mesh mesh;
    std::size_t parted = 0;  // number of original nodes that were split
    std::size_t parts = 1;   // 1 plus the increase in the number of connected components
};

/// Splits nodes at which several fans meet. A fan is a set of tetrahedra at a node that are connected through faces
/// with this node. Each fan except the first gets a new node at the same position. The boundary then touches itself
/// there, with one ring of triangles at each of these nodes.
///
/// - The shape of the tetrahedra is unchanged. Old nodes keep their indices, and new nodes are appended.
/// - Tetrahedra that share only an edge stay connected there if they belong to the same fan at both ends of the edge.
PartedMesh part_fans(const Mesh& mesh);

}  // namespace skerry::mesh
