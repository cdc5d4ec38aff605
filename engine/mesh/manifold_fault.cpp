#include "engine/mesh/manifold_fault.h"

#include <array>
#include <vector>

#include "components/union_find.h"
#include "engine/mesh/surface/sides.h"

namespace skerry::mesh {

std::size_t count_parts(const Mesh& mesh) {
    UnionFind parts;
    parts.start(mesh.nodes.size());
    for (const std::array<Index, 4>& t : mesh.tetrahedra)
        for (const Index n : t) parts.join(t[0], n);
    for (const std::array<Index, 3>& t : mesh.triangles)
        for (const Index n : t) parts.join(t[0], n);
    for (const std::array<Index, 4>& t : mesh.tetrahedra) parts.number(t[0]);
    for (const std::array<Index, 3>& t : mesh.triangles) parts.number(t[0]);
    return static_cast<std::size_t>(parts.number_count);
}

std::string manifold_fault(std::span<const BoundaryTriangle> boundary) {
    if (boundary.empty()) return "no boundary triangle";
    std::vector<std::array<Index, 3>> triangles;
    triangles.reserve(boundary.size());
    for (const BoundaryTriangle& triangle : boundary) triangles.push_back(triangle.node);
    UnionFind fans;
    fans.start(3 * triangles.size());
    std::string fault;  // description of the first violation
    std::size_t count = 0;
    const std::vector<Side> sides = sorted_sides(triangles);
    for_each_edge(sides, [&](std::span<const Side> edge) {
        if (edge.size() == 2)
            join_corners(fans, edge[0], edge[1]);
        else if (count++ == 0)
            fault = "an edge between nodes " + std::to_string(edge[0].node[0]) + " and " +
                    std::to_string(edge[0].node[1]) + " with " + std::to_string(edge.size()) +
                    " boundary triangles instead of 2";
    });
    if (count > 0) return count > 1 ? fault + " (" + std::to_string(count) + " such edges in total)" : fault;
    const std::vector<Index> meetings = further_fans(triangles, fans);
    if (meetings.empty()) return {};
    const auto corner = static_cast<std::size_t>(meetings.front());
    fault = "node " + std::to_string(triangles[corner / 3][corner % 3]) +
            ", at which parts of the boundary meet without a common edge";
    return meetings.size() > 1 ? fault + " (" + std::to_string(meetings.size()) + " such meetings in total)" : fault;
}

}  // namespace skerry::mesh
