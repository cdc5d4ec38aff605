// A mesh whose tetrahedra hang together by faces, not by corners alone.
#pragma once

#include <cstddef>

#include "skerry/mesh.h"

namespace skerry::mesh {

struct PartedMesh {
    Mesh mesh;
    std::size_t parted = 0;  // nodes that there were of them only one before
    std::size_t parts = 1;   // in which the tetrahedra fall apart then, beside those in which they did before
};

/// Tetrahedra around a node that hang together by faces with this node are a fan. Of several at one node all but the
/// first get a node of their own, in the same place, so that the boundary has one ring of triangles at each node; it
/// touches itself there. The tetrahedra stay what they were, and nodes keep their rows: new ones come behind. An edge
/// around which tetrahedra have a gap stays one where both of its ends have a single fan.
PartedMesh part_fans(const Mesh& mesh);

}  // namespace skerry::mesh
