#include "engine/mesh/tetrahedron.h"
#include "skerry/mesh.h"
#include "systems/collision/build_surface.h"

namespace skerry::mesh {

SurfaceMesh boundary(const Mesh& mesh) {
    require_valid(mesh, "mesh");
    SurfaceMesh surface;
    std::vector<Index> row(mesh.nodes.size(), no_index);
    const std::vector<BoundaryTriangle> triangles = boundary_triangles(mesh.tetrahedra);
    for (const BoundaryTriangle& t : triangles)
        for (const Index n : t.node) row[static_cast<std::size_t>(n)] = 0;
    // Surface nodes are numbered in the order of the nodes in the mesh, not in the order in which triangles use them.
    for (std::size_t n = 0; n < row.size(); ++n) {
        if (row[n] == no_index) continue;
        row[n] = static_cast<Index>(surface.nodes.size());
        surface.nodes.push_back(mesh.nodes[n]);
    }
    surface.triangles.reserve(triangles.size());
    for (const BoundaryTriangle& t : triangles)
        surface.triangles.push_back({row[static_cast<std::size_t>(t.node[0])], row[static_cast<std::size_t>(t.node[1])],
                                     row[static_cast<std::size_t>(t.node[2])]});
    return surface;
}

}  // namespace skerry::mesh
