#include "systems/dynamics/recovery/surface_gradient.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/dynamics/recovery/surface_search.h"
#include "systems/material/lane_math.h"
#include "systems/material/linear.h"
#include "systems/material/material_law.h"
#include "systems/material/stable_neo_hookean.h"

namespace skerry {

namespace {

/// Change of the first Piola-Kirchhoff stress if F changes by `of_F`, computed in principal axes as Tangent explains
/// [Pa].
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

constexpr int most_newton_passes = 20;
/// Newton's method ends when |P N - traction| is at most `newton_accuracy` |P| plus `newton_rounding` times the elastic
/// modulus, with the stress P and the normal N.
constexpr Real newton_accuracy = 1e-12, newton_rounding = 16 * std::numeric_limits<Real>::epsilon();

Real modulus_of(const MaterialConstants& material) {
    return 2 * material.shear_modulus + std::abs(material.lame_lambda);
}

/// Derivative d(P N)/db for F = base + b normal_row^T, with the stress P and the normal N (SurfaceAround in the
/// header). The function add_stiffness of a material law adds its terms through the member functions.
struct SlopeTerms {
    LaneVec3<Real8> normal_row, normal;
    LaneMat3<Real8> sum{};

    void add_identity(const Real8& s) {
        const Real8 x = s * dot(normal_row, normal);
        sum.c0.x += x;
        sum.c1.y += x;
        sum.c2.z += x;
    }
    template <class Matrix>
    void add_dyad(const Real8& s, const Matrix& X) {
        add(s, times(X, normal), times(X, normal_row));
    }
    template <class Matrix>
    void add_turned_transpose(const Real8& s, const Matrix& R) {
        add(s, times(R, normal_row), times(R, normal));
    }
    /// Adds s times the derivative of cof(F) N by b. A change u of b changes cof(F) N by the cross product of u and
    /// F w, where w is the cross product of N and `normal_row`.
    void add_cofactor_slope(const Real8& s, const LaneMat3<Real8>& F) {
        const LaneVec3<Real8> w = s * multiply(F, cross(normal, normal_row));
        sum.c0.y -= w.z;
        sum.c0.z += w.y;
        sum.c1.x += w.z;
        sum.c1.z -= w.x;
        sum.c2.x -= w.y;
        sum.c2.y += w.x;
    }

private:
    static LaneVec3<Real8> times(IdentityMatrix, const LaneVec3<Real8>& v) { return v; }
    static LaneVec3<Real8> times(const LaneMat3<Real8>& a, const LaneVec3<Real8>& v) { return multiply(a, v); }
    void add(const Real8& s, const LaneVec3<Real8>& left, const LaneVec3<Real8>& right) {
        sum = sum + LaneMat3<Real8>{(s * right.x) * left, (s * right.y) * left, (s * right.z) * left};
    }
};

void set_lane(LaneVec3<Real8>& to, int l, const Vec3& v) {
    to.x[l] = v.x();
    to.y[l] = v.y();
    to.z[l] = v.z();
}

/// Newton's method for up to eight nodes of one material, one in each lane. Lanes that have converged do not change.
/// The entries of `found` stay empty for lanes that do not converge.
template <class Law>
void search_lanes(Law law, std::span<const SurfaceSearch> searches, std::span<std::optional<Mat3>> found) {
    const MaterialConstants& material = searches.front().material;
    LaneMat3<Real8> base;
    LaneVec3<Real8> normal_row, normal, traction, b;
    for (int l = 0; l < static_cast<int>(element_lanes); ++l) {
        const SurfaceSearch& search = searches[std::min(static_cast<std::size_t>(l), searches.size() - 1)];
        const Mat3 own_base = search.area_gradient * search.around->plane_inverse;
        set_lane(base.c0, l, own_base.col(0));
        set_lane(base.c1, l, own_base.col(1));
        set_lane(base.c2, l, own_base.col(2));
        set_lane(normal_row, l, search.around->normal_row);
        set_lane(normal, l, search.around->normal);
        set_lane(traction, l, search.traction);
        set_lane(b, l, search.start);
    }
    LaneMat3<Real8> F;
    for (int pass = 0; pass < most_newton_passes; ++pass) {
        F = base + LaneMat3<Real8>{normal_row.x * b, normal_row.y * b, normal_row.z * b};
        const LaneMat3<Real8> P = whole(law.stress(material, F), F);
        const LaneVec3<Real8> excess = multiply(P, normal) - traction;
        const Real8 limit = newton_accuracy * square_root(inner_product(P, P)) + newton_rounding * modulus_of(material);
        const auto converged = square_root(dot(excess, excess)) <= limit;
        if (pass + 1 == most_newton_passes || all(converged)) {
            const Real8 J = determinant(F);
            for (std::size_t l = 0; l < searches.size(); ++l)
                if (converged[l] && J[l] > 0) found[l] = lane_of(F, static_cast<int>(l));
            return;
        }
        SlopeTerms slope{normal_row, normal};
        law.add_stiffness(material, F, slope);
        const LaneMat3<Real8> cof = cofactor(slope.sum);
        const Real8 inverse = (converged ? Real8{} : Real8{} + 1.0) / dot(slope.sum.c0, cof.c0);
        b = b - LaneVec3<Real8>{inverse * dot(cof.c0, excess), inverse * dot(cof.c1, excess),
                                inverse * dot(cof.c2, excess)};
    }
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
    // Lower limit on the cosine of the angle between a triangle and the mean surface (30 degrees). At a greater angle
    // the surface has an edge. So two faces whose normals differ by 60 degrees or more always form an edge.
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
    around.plane_inverse = plane * (plane.transpose() * projector * plane).inverse() * plane.transpose();
    around.normal_row = around.normal - around.plane_inverse * projector * around.normal;
    return around;
}

Mat3 surface_stretch(std::span<const SurfaceTriangle> triangles, std::span<const Vec3> position) {
    Mat3 area_gradient = Mat3::Zero();
    for (const SurfaceTriangle& triangle : triangles) {
        const Vec3 &x0 = position[static_cast<std::size_t>(triangle.node[0])],
                   &x1 = position[static_cast<std::size_t>(triangle.node[1])],
                   &x2 = position[static_cast<std::size_t>(triangle.node[2])];
        area_gradient += triangle.weight *
                         ((x1 - x0) * triangle.along_first.transpose() + (x2 - x0) * triangle.along_second.transpose());
    }
    return area_gradient;
}

std::optional<Mat3> surface_gradient(const MaterialConstants& material, const SurfaceAround& around,
                                     const Mat3& area_gradient, const Vec3& traction, const Vec3& start) {
    const Mat3 base = area_gradient * around.plane_inverse;
    const Real modulus = modulus_of(material);
    Vec3 b = start;
    for (int pass = 0; pass < most_newton_passes; ++pass) {
        const Mat3 F = base + b * around.normal_row.transpose(), P = stress(material, F);
        const Vec3 excess = P * around.normal - traction;
        if (excess.norm() <= newton_accuracy * P.norm() + newton_rounding * modulus)
            return F.determinant() > 0 ? std::optional(F) : std::nullopt;
        const Tangent tangent = skerry::tangent(material, F);
        Mat3 slope;
        for (Index j = 0; j < 3; ++j)
            slope.col(j) = change_of_stress(tangent, Vec3::Unit(j) * around.normal_row.transpose()) * around.normal;
        b -= slope.fullPivLu().solve(excess);
        if (!b.allFinite()) break;
    }
    return std::nullopt;
}

std::vector<std::optional<Mat3>> surface_gradients(std::span<const SurfaceSearch> searches) {
    std::vector<std::optional<Mat3>> found(searches.size());
    for (std::size_t begin = 0, end = 0; begin < searches.size(); begin = end) {
        const MaterialConstants& material = searches[begin].material;
        const auto is_same = [&](const MaterialConstants& other) {
            return other.model == material.model && other.shear_modulus == material.shear_modulus &&
                   other.lame_lambda == material.lame_lambda;
        };
        while (end < searches.size() && end < begin + element_lanes && is_same(searches[end].material)) ++end;
        const auto nodes = searches.subspan(begin, end - begin);
        const auto results = std::span(found).subspan(begin, end - begin);
        if (material.model == MaterialModel::stable_neo_hookean) search_lanes(StableNeoHookean{}, nodes, results);
        if (material.model == MaterialModel::linear) search_lanes(Linear{}, nodes, results);
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (!results[i])
                results[i] = surface_gradient(nodes[i].material, *nodes[i].around, nodes[i].area_gradient,
                                              nodes[i].traction, nodes[i].start);
    }
    return found;
}

}  // namespace skerry
