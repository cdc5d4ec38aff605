#include "systems/material/extract_rotation.h"

#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

using Vector4 = std::array<Real, 4>;

/// Eigenvalues and eigenvectors of a symmetric 4x4 matrix. eigen_of() computes them by cyclic Jacobi rotations (Golub,
/// Van Loan, 8.5). It uses plain loops: the vectorised code of a library would give other bits on other processors.
struct Eigen4 {
    Vector4 value;
    std::array<Vector4, 4> vector;  // vector[i] is the eigenvector of value[i]
};

Eigen4 eigen_of(std::array<Vector4, 4> a) {
    std::array<Vector4, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) v[i][i] = 1;
    constexpr int max_sweeps = 12;  // convergence is quadratic: 5 to 6 sweeps are enough for doubles
    for (int sweep = 0; sweep < max_sweeps; ++sweep) {
        Real off = 0;
        for (std::size_t p = 0; p < 4; ++p)
            for (std::size_t q = p + 1; q < 4; ++q) off += a[p][q] * a[p][q];
        if (!(off > 1e-36)) break;  // absolute limit, because the entries of the matrix are of order 1
        for (std::size_t p = 0; p < 4; ++p) {
            for (std::size_t q = p + 1; q < 4; ++q) {
                if (a[p][q] == 0) continue;
                const Real theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const Real t = std::copysign(1 / (std::abs(theta) + std::sqrt(theta * theta + 1)), theta);
                const Real c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (std::size_t k = 0; k < 4; ++k) {  // columns
                    const Real kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - s * kq;
                    a[k][q] = s * kp + c * kq;
                }
                for (std::size_t k = 0; k < 4; ++k) {  // rows of the matrix, and the eigenvectors
                    const Real pk = a[p][k], qk = a[q][k], vp = v[p][k], vq = v[q][k];
                    a[p][k] = c * pk - s * qk;
                    a[q][k] = s * pk + c * qk;
                    v[p][k] = c * vp - s * vq;
                    v[q][k] = s * vp + c * vq;
                }
            }
        }
    }
    return {{a[0][0], a[1][1], a[2][2], a[3][3]}, v};
}

Real dot4(const Vector4& a, const Vector4& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

}  // namespace

std::array<Real, 4> nearest_rotation(const Mat3& F, const std::array<Real, 4>& start) {
    const Real scale = F.cwiseAbs().maxCoeff();
    if (!F.allFinite() || scale == 0) return start;
    // A unit quaternion q and its rotation R(q) satisfy tr(R(q)^T F) = q^T K q, with a symmetric 4x4 matrix K (Horn
    // 1987).
    const Mat3 A = F / scale;
    const Real wx = A(2, 1) - A(1, 2), wy = A(0, 2) - A(2, 0), wz = A(1, 0) - A(0, 1);
    const Real xy = A(0, 1) + A(1, 0), yz = A(1, 2) + A(2, 1), zx = A(2, 0) + A(0, 2);
    const Real xx = A(0, 0), yy = A(1, 1), zz = A(2, 2);
    const Eigen4 eigen = eigen_of({{{xx + yy + zz, wx, wy, wz},
                                    {wx, xx - yy - zz, xy, zx},
                                    {wy, xy, yy - xx - zz, yz},
                                    {wz, zx, yz, zz - xx - yy}}});
    const auto top =
        static_cast<std::size_t>(std::max_element(eigen.value.begin(), eigen.value.end()) - eigen.value.begin());
    // Projects `start` onto the eigenvectors whose eigenvalues are (nearly) the largest, so that the rotation of a
    // degenerate element does not jump.
    constexpr Real tie = 1e-6;  // tolerance for equal eigenvalues, relative to the largest entry of F
    Vector4 q{};
    for (std::size_t i = 0; i < 4; ++i) {
        if (eigen.value[i] < eigen.value[top] - tie) continue;
        const Real share = dot4(eigen.vector[i], start);
        for (std::size_t k = 0; k < 4; ++k) q[k] += share * eigen.vector[i][k];
    }
    // If `start` is orthogonal to all these eigenvectors, one of them is taken, because none is nearer to `start`.
    if (!(dot4(q, q) > 1e-12)) q = eigen.vector[top];
    const Real length = std::sqrt(dot4(q, q));
    return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

template <class T>
void solve_rotations(const LaneMat3<T>& F, const T& volume, LaneQuaternion<T>& start) {
    for (int l = 0; l < static_cast<int>(lanes_of<T>); ++l) {
        if (volume[l] == 0) continue;
        const std::array<Real, 4> q = nearest_rotation(lane_of(F, l), {start.w[l], start.x[l], start.y[l], start.z[l]});
        start.w[l] = q[0];
        start.x[l] = q[1];
        start.y[l] = q[2];
        start.z[l] = q[3];
    }
}
template void solve_rotations(const LaneMat3<Real4>& F, const Real4& volume, LaneQuaternion<Real4>& start);
template void solve_rotations(const LaneMat3<Real8>& F, const Real8& volume, LaneQuaternion<Real8>& start);

}  // namespace skerry
