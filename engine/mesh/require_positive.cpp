#include "engine/mesh/require_positive.h"

#include "engine/base/complaint.h"
#include "engine/mesh/tetrahedron.h"

namespace skerry::mesh {

void require_positive(const Mesh& mesh, const std::string& name) {
    if (mesh.tetrahedra.empty()) refuse_in(name, "mesh", {}, "no tetrahedra", "at least one tetrahedron");
    require_valid(mesh, name);
    std::size_t inverted = 0, flat = 0, first = mesh.tetrahedra.size();
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        const Orientation side = orientation(mesh, mesh.tetrahedra[e]);
        if (side == Orientation::positive) continue;
        (side == Orientation::flat ? flat : inverted) += 1;
        if (first == mesh.tetrahedra.size()) first = e;
    }
    if (inverted + flat == 0) return;

    const std::array<Index, 4>& t = mesh.tetrahedra[first];
    std::string nodes;
    for (const Index node : t) nodes += " " + std::to_string(node);
    refuse_in(name, "tetrahedron " + std::to_string(first) + " (nodes" + nodes + ")", "rest volume",
              short_text(six_volumes(mesh, t) / 6, 6) + " m^3", "a positive volume",
              "inverted: " + std::to_string(inverted) + ", flat: " + std::to_string(flat) + " of " +
                  std::to_string(mesh.tetrahedra.size()) +
                  " tetrahedra, numbered from 0; repair the mesh with skerry inspect MESH --repair OUT.msh");
}

}  // namespace skerry::mesh
