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

/// Describes the first edge at which a surface is not closed, and counts such edges: "an edge between nodes 3 and 5
/// that 1 triangle has in one direction and 0 in the other (2 such edges in total)". Returns an empty text for a closed
/// surface. Shells of a closed surface may touch each other in nodes and edges.
std::string open_edge(std::span<const BoundaryTriangle> surface);

/// Describes the first violation of a closed manifold, with the node numbers of the mesh, and counts such violations:
/// "node 3, at which parts of the boundary meet without a common edge (2 such meetings in total)". Returns an empty
/// text if there is no violation. In a closed manifold each edge has two triangles, and the triangles around each node
/// form one ring.
std::string manifold_fault(std::span<const BoundaryTriangle> boundary);

}  // namespace skerry::mesh
