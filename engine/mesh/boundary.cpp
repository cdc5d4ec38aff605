#include "engine/mesh/tetrahedron.h"
#include "engine/mesh/used_nodes.h"
#include "skerry/mesh.h"
#include "systems/collision/build_surface.h"

namespace skerry::mesh {

SurfaceMesh boundary(const Mesh& mesh) {
    require_valid(mesh, "mesh");
    SurfaceMesh surface;
    for (const BoundaryTriangle& t : boundary_triangles(mesh.tetrahedra)) surface.triangles.push_back(t.node);
    surface.nodes = drop_unused(mesh.nodes, surface.triangles).nodes;
    return surface;
}

}  // namespace skerry::mesh
