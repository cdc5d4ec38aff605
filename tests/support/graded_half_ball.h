// A mesh for contact at one point: fine there, coarse far away.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "skerry/mesh.h"

namespace skerry::test {

/// Half a ball below z = 0, centred at the origin: the shells of a block of cubes, mapped onto half spheres. The radius
/// a has `fine` shells, so that elements there are a / fine thick. Beyond a the shells grow by a factor of e^(growth /
/// fine) from one to the next until the radius is reached.
struct HalfBallShape {
    Real a = 1;  // [m]
    int fine = 4;
    Real growth = 4;   // logarithm of the growth in thickness over `fine` shells
    Real radius = 30;  // lower bound [m]

    int shells() const {
        return fine + static_cast<int>(std::ceil(fine * std::log1p(growth * (radius / a - 1)) / growth));
    }
    Real shell_radius(int shell) const {
        const Real s = Real(shell) / fine;
        return a * (s <= 1 ? s : 1 + std::expm1(growth * (s - 1)) / growth);
    }
};

inline Mesh graded_half_ball(const HalfBallShape& shape) {
    const int n = shape.shells();
    Mesh mesh = mesh::box({Real(2 * n), Real(2 * n), Real(n)}, {2 * n, 2 * n, n});
    for (Vec3& x : mesh.nodes) {
        x.z() -= Real(n) / 2;
        const Vec3 whole(std::round(x.x()), std::round(x.y()), std::round(x.z()));
        const int shell = static_cast<int>(whole.cwiseAbs().maxCoeff());
        x = shell == 0 ? Vec3(Vec3::Zero()) : Vec3(shape.shell_radius(shell) * whole.normalized());
    }
    return mesh;
}

/// Swaps two corners of each tetrahedron with negative volume.
inline void orient(Mesh& mesh) {
    for (auto& t : mesh.tetrahedra) {
        const auto edge = [&](std::size_t i) -> Vec3 {
            return mesh.nodes[static_cast<std::size_t>(t[i])] - mesh.nodes[static_cast<std::size_t>(t[0])];
        };
        if (edge(1).cross(edge(2)).dot(edge(3)) < 0) std::swap(t[2], t[3]);
    }
}

/// Maps the half ball by an inversion, which keeps angles. The flat face becomes the sphere of the given radius that
/// touches z = 0 at the origin from above; its fine middle becomes the lowest point. The top of the sphere, where the
/// outermost shell ends up, is cut off.
inline void roll_up(Mesh& mesh, Real radius) {
    const Vec3 top(0, 0, 2 * radius);
    for (Vec3& x : mesh.nodes) x = top + 4 * radius * radius / (x - top).squaredNorm() * (x - top);
    orient(mesh);
}

}  // namespace skerry::test
