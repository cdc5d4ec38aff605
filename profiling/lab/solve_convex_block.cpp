#include "profiling/lab/solve_convex_block.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace skerry::lab {
namespace {

/// Returns the first coordinate y of the solution on the surface of the cone, r = T (y, y_1, y_2). With the multiplier
/// s of S(r) <= 0 the rows (1 + s sigma_i) y_i = -c_i give y_i = -c_i y / d_i, d_i = (1 + k_i) y + k_i c_0, and S(r) =
/// 0 becomes N(y) = 1 with N^2 = sum k_i c_i^2 / d_i^2. The function of y has no pole, unlike that of s, and 1/N is
/// concave (a power mean of d_i). Newton's method from the left therefore converges to the only root from below.
Real find_height(const ConvexBlock& block, const Vec3& c) {
    Real y = std::max(Real(0), -c[0]);
    for (int i = 0; i < 2; ++i) {
        const Real k = block.ratio[i];
        y = std::max(y, (std::sqrt(k) * std::abs(c[i + 1]) - k * c[0]) / (1 + k));  // where this term alone is 1
    }
    constexpr int iteration_limit = 60;  // bounds the time if the ratios are extreme
    for (int iteration = 0; iteration < iteration_limit; ++iteration) {
        Real squared = 0, slope = 0;  // N^2 and -N N'
        for (int i = 0; i < 2; ++i) {
            const Real k = block.ratio[i], d = (1 + k) * y + k * c[0];
            if (c[i + 1] == 0) continue;
            const Real part = k * (c[i + 1] / d) * (c[i + 1] / d);
            squared += part;
            slope += part * (1 + k) / d;
        }
        const Real step = squared * (std::sqrt(squared) - 1) / slope;
        if (!(step > 2 * std::numeric_limits<Real>::epsilon() * y)) break;
        y += step;
    }
    return y;
}

}  // namespace

ConvexBlock prepare_convex_block(const Mat3& matrix, Real mu) {
    ConvexBlock block{Mat3::Zero(), {1, 1}, 0};
    if (!(matrix(0, 0) > 0)) return block;
    block.inverse_normal = 1 / matrix(0, 0);
    if (mu == 0) return block;
    constexpr Real rank_rounding = 1e-14;  // relative to the trace
    const Mat3 symmetric = 0.5 * (matrix + matrix.transpose()) + (rank_rounding * matrix.trace()) * Mat3::Identity();
    const Mat3 inverse_factor = Mat3(symmetric.llt().matrixL()).inverse();
    const Vec3 cone(-mu * mu, 1, 1);
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inverse_factor * cone.asDiagonal() * inverse_factor.transpose());
    block.axes = inverse_factor.transpose() * eigen.eigenvectors();
    if (block.axes(0, 0) < 0) block.axes.col(0) *= -1;
    for (int i = 0; i < 2; ++i) block.ratio[i] = eigen.eigenvalues()[i + 1] / -eigen.eigenvalues()[0];
    return block;
}

Vec3 solve_convex_block(const ConvexBlock& block, const Vec3& b, Real mu) {
    if (block.inverse_normal == 0 || b[0] >= mu * std::hypot(b[1], b[2])) return Vec3::Zero();
    if (mu == 0) return {-b[0] * block.inverse_normal, 0, 0};
    const Vec3 c = block.axes.transpose() * b;
    const Vec3 stopping = -(block.axes * c);
    if (std::hypot(stopping[1], stopping[2]) <= mu * stopping[0]) return stopping;
    const Real y = find_height(block, c);
    Vec3 height(y, 0, 0);
    for (int i = 0; i < 2; ++i)
        if (c[i + 1] != 0) height[i + 1] = -c[i + 1] * (y / ((1 + block.ratio[i]) * y + block.ratio[i] * c[0]));
    Vec3 r = block.axes * height;
    const Real shrink = mu * r[0] / std::hypot(r[1], r[2]);  // puts r onto the cone to the last bit
    if (std::isfinite(shrink)) r.tail<2>() *= shrink;
    return r;
}

}  // namespace skerry::lab
