#include "engine/mesh/require_positive.h"

#include <sstream>

#include "engine/mesh/tetrahedron.h"
#include "skerry/error.h"

namespace skerry::mesh {

void require_positive(const Mesh& mesh, const std::string& what) {
    if (mesh.tetrahedra.empty()) Complaint{what, "mesh", {}, "no tetrahedra", "at least one tetrahedron", {}}.raise();
    require_valid(mesh, what);
    std::size_t inverted = 0, flat = 0, first = mesh.tetrahedra.size();
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        const Orientation side = orientation(mesh, mesh.tetrahedra[e]);
        if (side == Orientation::positive) continue;
        (side == Orientation::flat ? flat : inverted) += 1;
        if (first == mesh.tetrahedra.size()) first = e;
    }
    if (inverted + flat == 0) return;

    const std::array<Index, 4>& t = mesh.tetrahedra[first];
    std::ostringstream object, found, hint;
    object << "tetrahedron " << first << " (nodes " << t[0] << ' ' << t[1] << ' ' << t[2] << ' ' << t[3] << ')';
    found << six_volumes(mesh, t) / 6 << " m^3";
    hint << "inverted: " << inverted << ", flat: " << flat << " of " << mesh.tetrahedra.size()
         << " tetrahedra, numbered from 0; repair the mesh with skerry inspect MESH --repair OUT.msh";
    Complaint{what, object.str(), "rest volume", found.str(), "a positive volume", hint.str()}.raise();
}

}  // namespace skerry::mesh
