#include "systems/dynamics/recovery/surface_gradient.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "systems/material/material_law.h"

namespace skerry {

namespace {

/// Change of the first Piola-Kirchhoff stress by a change of F [Pa].
Mat3 change_of_stress(const Tangent& tangent, const Mat3& of_F) {
    const Mat3 x = tangent.left.transpose() * of_F * tangent.right;
    Mat3 change = Mat3::Zero();
    change.diagonal() = tangent.normal * x.diagonal();
    for (Index i = 0; i < 3; ++i)
        for (Index j = 0; j < 3; ++j)
            if (i != j) {
                const Index pair = 3 - i - j;
                change(i, j) = (tangent.flip[pair] + tangent.twist[pair]) / 2 * x(i, j) +
                               (tangent.flip[pair] - tangent.twist[pair]) / 2 * x(j, i);
            }
    change = tangent.left * change * tangent.right.transpose();
    if (!tangent.is_anisotropic) return change;
    for (const Mat3& dyad : tangent.dyads) change += dyad.cwiseProduct(of_F).sum() * dyad;
    return change + of_F * tangent.second_stress;
}

/// Two orthonormal vectors orthogonal to the unit vector `normal`.
Eigen::Matrix<Real, 3, 2> plane_of(const Vec3& normal) {
    Index axis = 0;
    normal.cwiseAbs().minCoeff(&axis);
    Eigen::Matrix<Real, 3, 2> plane;
    plane.col(0) = normal.cross(Vec3::Unit(axis)).normalized();
    plane.col(1) = normal.cross(plane.col(0));
    return plane;
}

}  // namespace

std::optional<SurfaceTriangle> surface_triangle(const std::array<Index, 3>& node, std::span<const Vec3> rest) {
    const Vec3& origin = rest[static_cast<std::size_t>(node[0])];
    const Vec3 along1 = rest[static_cast<std::size_t>(node[1])] - origin,
               along2 = rest[static_cast<std::size_t>(node[2])] - origin, n = along1.cross(along2);
    const Real square = n.squaredNorm();
    if (!(square > 0)) return std::nullopt;
    const Real area = std::sqrt(square) / 2;
    return SurfaceTriangle{node, along2.cross(n), n.cross(along1), area / square};
}

SurfaceAround surface_around(std::span<const std::array<Index, 3>> surface, std::span<const Index> triangles,
                             std::span<const Vec3> rest) {
    // Least cosine of the angle between a triangle and the mean surface. Two faces that form an edge differ by 60
    // degrees or more.
    constexpr Real least_cosine = 0.866;
    const auto corner = [&](Index t, std::size_t k) {
        return static_cast<std::size_t>(surface[static_cast<std::size_t>(t)][k]);
    };
    const auto twice_area = [&](Index t) -> Vec3 {
        const Vec3& origin = rest[corner(t, 0)];
        return (rest[corner(t, 1)] - origin).cross(rest[corner(t, 2)] - origin);
    };
    SurfaceAround around;
    for (const Index t : triangles) around.area += twice_area(t) / 6;
    if (!(around.area.squaredNorm() > 0)) return around;
    around.normal = around.area.normalized();
    around.smooth = true;
    Mat3 projector = Mat3::Zero();  // sum of area times the projector onto the plane of the triangle [m^2]
    for (const Index t : triangles) {
        const Vec3 n = twice_area(t);
        const Real square = n.squaredNorm();
        if (!(square > 0)) continue;
        const Real area = std::sqrt(square) / 2;
        around.smooth = around.smooth && n.dot(around.normal) >= least_cosine * 2 * area;
        projector += area * (Mat3::Identity() - n * n.transpose() / square);
    }
    if (!around.smooth) return around;
    const Eigen::Matrix<Real, 3, 2> plane = plane_of(around.normal);
    around.inverse = plane * (plane.transpose() * projector * plane).inverse() * plane.transpose();
    around.across = around.normal - around.inverse * projector * around.normal;
    return around;
}

Mat3 surface_stretch(std::span<const SurfaceTriangle> triangles, std::span<const Vec3> position) {
    Mat3 stretch = Mat3::Zero();
    for (const SurfaceTriangle& triangle : triangles) {
        const Vec3 &x0 = position[static_cast<std::size_t>(triangle.node[0])],
                   &x1 = position[static_cast<std::size_t>(triangle.node[1])],
                   &x2 = position[static_cast<std::size_t>(triangle.node[2])];
        stretch += triangle.weight *
                   ((x1 - x0) * triangle.along_first.transpose() + (x2 - x0) * triangle.along_second.transpose());
    }
    return stretch;
}

std::optional<Mat3> surface_gradient(const MaterialConstants& material, const SurfaceAround& around,
                                     const Mat3& stretch, const Vec3& traction, const Vec3& start) {
    const Mat3 base = stretch * around.inverse;
    constexpr int most_passes = 20;
    constexpr Real accuracy = 1e-12, rounding = 16 * std::numeric_limits<Real>::epsilon();
    const Real modulus = 2 * material.shear_modulus + std::abs(material.lame_lambda);
    Vec3 b = start;
    for (int pass = 0; pass < most_passes; ++pass) {
        const Mat3 F = base + b * around.across.transpose(), P = stress(material, F);
        const Vec3 excess = P * around.normal - traction;
        if (excess.norm() <= accuracy * P.norm() + rounding * modulus)
            return F.determinant() > 0 ? std::optional(F) : std::nullopt;
        const Tangent tangent = skerry::tangent(material, F);
        Mat3 slope;
        for (Index j = 0; j < 3; ++j)
            slope.col(j) = change_of_stress(tangent, Vec3::Unit(j) * around.across.transpose()) * around.normal;
        b -= slope.fullPivLu().solve(excess);
        if (!b.allFinite()) break;
    }
    return std::nullopt;
}

}  // namespace skerry
