// Makes a mesh whose tetrahedra are connected by faces, not by nodes alone.
#pragma once

#include <cstddef>

#include "skerry/mesh.h"

namespace skerry::mesh {

struct PartedMesh {
    Mesh mesh;
    std::size_t parted = 0;  // number of original nodes that were split
    std::size_t parts = 1;   // 1 plus the increase in the number of connected components
};

/// A fan is a set of tetrahedra around a node, connected by faces with this node. If a node has several fans, all but
/// the first get a new node at the same position. The boundary then has one ring of triangles at each node and touches
/// itself there. The shape of the tetrahedra is unchanged, and nodes keep their rows; new ones are appended. An edge
/// around which the tetrahedra leave gaps stays unsplit if both of its ends have a single fan.
PartedMesh part_fans(const Mesh& mesh);

}  // namespace skerry::mesh
