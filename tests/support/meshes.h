// Small tetrahedral meshes for collision tests.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "components/types.h"

namespace skerry::test {

struct SolidMesh {
    std::vector<Vec3> nodes;                       // [m]
    std::vector<std::array<Index, 4>> tetrahedra;  // positive volumes
};

/// A box centred at the origin, cut into cells of six tetrahedra each (Kuhn).
inline SolidMesh box_mesh(const std::array<Index, 3>& cells, const Vec3& size) {
    SolidMesh mesh;
    const auto row = [&](Index i, Index j, Index k) { return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i; };
    for (Index k = 0; k <= cells[2]; ++k)
        for (Index j = 0; j <= cells[1]; ++j)
            for (Index i = 0; i <= cells[0]; ++i)
                mesh.nodes.push_back(Vec3(Real(i) / cells[0] - 0.5, Real(j) / cells[1] - 0.5, Real(k) / cells[2] - 0.5)
                                         .cwiseProduct(size));
    constexpr std::array<std::array<std::size_t, 3>, 6> path{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (Index k = 0; k < cells[2]; ++k)
        for (Index j = 0; j < cells[1]; ++j)
            for (Index i = 0; i < cells[0]; ++i)
                for (std::size_t p = 0; p < 6; ++p) {
                    std::array<Index, 3> at{i, j, k};
                    std::array<Index, 4> tet{row(i, j, k), 0, 0, 0};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++at[path[p][step]];
                        tet[step + 1] = row(at[0], at[1], at[2]);
                    }
                    if (p >= 3) std::swap(tet[1], tet[2]);  // odd paths are mirrored
                    mesh.tetrahedra.push_back(tet);
                }
    return mesh;
}

/// A ball: a cube of n^3 cells whose shells are mapped onto spheres. 4 cells: 384 tetrahedra, 192 surface triangles.
inline SolidMesh ball_mesh(Real radius, Index cells) {
    SolidMesh mesh = box_mesh({cells, cells, cells}, Vec3::Constant(2));
    for (Vec3& x : mesh.nodes) {
        const Real shell = x.cwiseAbs().maxCoeff();
        if (shell > 0) x *= radius * shell / x.norm();
    }
    return mesh;
}

}  // namespace skerry::test
