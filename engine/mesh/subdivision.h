// Uniform subdivision of a mesh, with a record of the old elements and the new nodes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// The nodes and elements of a mesh before a subdivision, and the nodes that were added at the midpoints of edges.
struct Subdivision {
    std::size_t node_count = 0;  // number of nodes before the subdivision
    std::vector<std::array<Index, 4>> tetrahedra{};
    std::vector<std::array<Index, 6>> middle{};  // edge midpoints of each tetrahedron, see second_order_edges
    std::vector<std::array<Index, 3>> triangles{};
    std::vector<std::array<Index, 3>> triangle_middle{};
};

/// Divides a mesh as `refine` does, and returns a record of the division.
Subdivision subdivide(Mesh& mesh);

/// Appends midpoints of edges to a set of nodes, in ascending order. The rule of `refine` says which midpoints belong
/// to the set.
void add_midpoints(const Subdivision& subdivision, std::vector<Index>& nodes);

}  // namespace skerry::mesh
