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

/// Appends to a set of nodes the midpoints that belong to the set by the rule of `refine`, in ascending order.
void add_midpoints(const Subdivision& subdivision, std::vector<Index>& nodes);

}  // namespace skerry::mesh
