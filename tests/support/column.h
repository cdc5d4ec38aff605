// A bar with a one-dimensional mesh. Closed forms for bars hold on it to rounding if they hold on a chain of points and
// springs.
#pragma once

#include <Eigen/Geometry>
#include <utility>

#include "skerry/mesh.h"

namespace skerry::test {

/// Area of the cross-section of a column [m^2].
constexpr Real column_area(Real width) {
    return width * width / 2;
}

/// A column along z, centred in z, over a right triangle with two sides of `width`, in n layers of three tetrahedra.
/// Each tetrahedron has one edge along the column. All corners of an interior layer thus have equal mass and, without
/// lateral strain, equal force: for Poisson ratio 0 the layers move like the points of a chain. At the two ends the
/// masses of the corners are as 1 : 2 : 3 and 3 : 2 : 1. Nodes 3 k to 3 k + 2 form layer k.
inline Mesh column(Real width, Real length, int n) {
    Mesh mesh;
    for (int k = 0; k <= n; ++k) {
        const Real z = length * (static_cast<Real>(k) / n - 0.5);
        for (const Vec3& corner : {Vec3(0, 0, z), Vec3(width, 0, z), Vec3(0, width, z)}) mesh.nodes.push_back(corner);
    }
    for (int k = 0; k < n; ++k) {
        const Index a = 3 * k, above = a + 3;
        mesh.tetrahedra.push_back({a, a + 1, a + 2, above});
        mesh.tetrahedra.push_back({a + 2, a + 1, above + 1, above});
        mesh.tetrahedra.push_back({a + 2, above + 1, above + 2, above});
    }
    for (auto& t : mesh.tetrahedra) {
        const auto edge = [&](std::size_t i) -> Vec3 {
            return mesh.nodes[static_cast<std::size_t>(t[i])] - mesh.nodes[static_cast<std::size_t>(t[0])];
        };
        if (edge(1).cross(edge(2)).dot(edge(3)) < 0) std::swap(t[0], t[1]);
    }
    return mesh;
}

}  // namespace skerry::test
