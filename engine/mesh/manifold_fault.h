// Topology of a mesh: its parts, and whether its boundary is a closed manifold.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "skerry/mesh.h"
#include "systems/collision/build_surface.h"

namespace skerry::mesh {

/// Number of parts of a mesh. Tetrahedra or triangles that share a node belong to the same part.
std::size_t count_parts(const Mesh& mesh);

/// Describes why a boundary is not a closed manifold; returns an empty text if it is one. In a closed manifold each
/// edge has two triangles, and the triangles around each node form one ring.
///
/// The text names the nodes of the first violation and counts all violations of its kind, for example "node 3, at which
/// parts of the boundary meet without a common edge (2 such meetings in total)".
std::string manifold_fault(std::span<const BoundaryTriangle> boundary);

}  // namespace skerry::mesh
