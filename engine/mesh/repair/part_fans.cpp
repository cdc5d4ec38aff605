#include "engine/mesh/repair/part_fans.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "components/union_find.h"
#include "engine/mesh/manifold_fault.h"

namespace skerry::mesh {

namespace {

/// A face of a tetrahedron: its nodes in ascending order, and the corners at these nodes. Corner k of tetrahedron t has
/// the number 4 t + k.
struct Face {
    std::array<Index, 3> node, corner;
};

std::vector<Face> faces_of(const Mesh& mesh) {
    std::vector<Face> faces;
    faces.reserve(4 * mesh.tetrahedra.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t opposite = 0; opposite < 4; ++opposite) {
            std::array<std::size_t, 3> corner{(opposite + 1) % 4, (opposite + 2) % 4, (opposite + 3) % 4};
            std::ranges::sort(corner, {}, [&](std::size_t k) { return mesh.tetrahedra[t][k]; });
            Face face;
            for (std::size_t i = 0; i < 3; ++i) {
                face.node[i] = mesh.tetrahedra[t][corner[i]];
                face.corner[i] = static_cast<Index>(4 * t + corner[i]);
            }
            faces.push_back(face);
        }
    std::ranges::sort(faces, {}, [](const Face& face) { return std::tuple(face.node, face.corner); });
    return faces;
}

}  // namespace

PartedMesh part_fans(const Mesh& mesh) {
    PartedMesh result{.mesh = mesh};
    const std::vector<Face> faces = faces_of(mesh);
    UnionFind fans;
    fans.start(4 * mesh.tetrahedra.size());
    for (std::size_t f = 1; f < faces.size(); ++f)
        if (faces[f].node == faces[f - 1].node)
            for (std::size_t i = 0; i < 3; ++i) fans.join(faces[f].corner[i], faces[f - 1].corner[i]);
    std::vector<Index> first_fan(mesh.nodes.size(), no_index);  // number of the first fan found at each node
    // Node of each fan after the split. A fan is numbered by its first corner, which is its root in the union-find
    // structure.
    std::vector<Index> node_of(4 * mesh.tetrahedra.size(), no_index);
    std::vector<bool> has_more(mesh.nodes.size());
    for (std::size_t c = 0; c < node_of.size(); ++c) {
        const auto root = static_cast<std::size_t>(fans.root(static_cast<Index>(c)));
        Index& corner = result.mesh.tetrahedra[c / 4][c % 4];
        const auto n = static_cast<std::size_t>(corner);
        if (node_of[root] == no_index) {
            node_of[root] = corner;
            if (first_fan[n] == no_index) {
                first_fan[n] = static_cast<Index>(root);
            } else {
                node_of[root] = static_cast<Index>(result.mesh.nodes.size());
                result.mesh.nodes.push_back(mesh.nodes[n]);
                has_more[n] = true;
            }
        }
        corner = node_of[root];
    }
    result.parted = static_cast<std::size_t>(std::ranges::count(has_more, true));
    if (result.parted > 0) result.parts = 1 + count_parts(result.mesh) - count_parts(mesh);
    return result;
}

}  // namespace skerry::mesh
