#include <Eigen/LU>
#include <algorithm>

#include "components/check.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

namespace {

/// Edge vectors of a tetrahedron at rest, as columns: corners 1 to 3 minus corner 0.
Mat3 rest_edges(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> position) {
    const auto at = [&](std::size_t a) -> const Vec3& { return position[static_cast<std::size_t>(tetrahedron[a])]; };
    Mat3 Dm;
    Dm << at(1) - at(0), at(2) - at(0), at(3) - at(0);
    return Dm;
}

}  // namespace

Real six_volumes(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position) {
    return rest_edges(tetrahedron, rest_position).determinant();
}

std::vector<std::uint8_t> sliver_tetrahedra(const RestMesh& mesh) {
    std::vector<Real> six_volume;
    // Six times the mean volume of the tetrahedra around each node, and the number of these tetrahedra.
    std::vector<Real> mean(mesh.position.size()), around(mesh.position.size());
    for (const auto& tetrahedron : mesh.tetrahedra) {
        six_volume.push_back(six_volumes(tetrahedron, mesh.position));
        for (const Index n : tetrahedron) {
            mean[static_cast<std::size_t>(n)] += six_volume.back();
            around[static_cast<std::size_t>(n)] += 1;
        }
    }
    for (std::size_t n = 0; n < mean.size(); ++n)
        if (around[n] > 0) mean[n] /= around[n];
    std::vector<std::uint8_t> sliver;
    for (std::size_t t = 0; t < six_volume.size(); ++t)
        sliver.push_back(std::ranges::all_of(mesh.tetrahedra[t], [&](Index n) {
            return six_volume[t] < sliver_volume * mean[static_cast<std::size_t>(n)];
        }));
    return sliver;
}

TetrahedronGradients tetrahedron_gradients(const std::array<Index, 4>& tetrahedron,
                                           std::span<const Vec3> rest_position) {
    const Mat3 Dm = rest_edges(tetrahedron, rest_position);
    const Real determinant = Dm.determinant();
    SKERRY_CHECK(determinant > 0);
    const Mat3 B = Dm.inverse();
    TetrahedronGradients out;
    for (std::size_t a = 0; a < 3; ++a) out.g[a + 1] = B.row(static_cast<Eigen::Index>(a)).transpose();
    out.g[0] = -(out.g[1] + out.g[2] + out.g[3]);
    out.volume = determinant / 6;
    return out;
}

void add_tetrahedron_elements(const RestMesh& mesh, ElementList& list) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const TetrahedronGradients rest = tetrahedron_gradients(mesh.tetrahedra[t], mesh.position);
        list.node.insert(list.node.end(), mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
        list.gradient.insert(list.gradient.end(), rest.g.begin(), rest.g.end());
        list.first_node.push_back(list.node.size());
        list.tetrahedron.push_back(static_cast<Index>(t));
        list.first_tetrahedron.push_back(list.tetrahedron.size());
        list.volume.push_back(rest.volume);
        list.part.push_back(ElementPart::whole);
    }
}

}  // namespace skerry
