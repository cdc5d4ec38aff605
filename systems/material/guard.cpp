#include "systems/material/guard.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

Real missing_volume(const Mat3& F) {
    return std::max(Guard::barrier_ratio - F.determinant(), Real(0));
}

Mat3 cofactors(const Mat3& F) {
    Mat3 cof;
    cof << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
    return cof;
}

}  // namespace

Real Guard::energy_density(const MaterialConstants& material, const Mat3& F) {
    return 0.5 * material.lame_lambda * missing_volume(F) * missing_volume(F);
}

Mat3 Guard::stress(const MaterialConstants& material, const Mat3& F) {
    return -material.lame_lambda * missing_volume(F) * cofactors(F);
}

Real Guard::stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    const Real missing = missing_volume(F);
    if (missing == 0) return 0;
    return material.lame_lambda * (cofactors(F).squaredNorm() + 2 / std::sqrt(Real{3}) * missing * F.norm());
}

Tangent Guard::tangent(const MaterialConstants& material, const Mat3& F) {
    const Stretches frames(F);
    const Vec3& s = frames.stretch;
    const Vec3 cof(s[1] * s[2], s[2] * s[0], s[0] * s[1]);
    const Real missing = missing_volume(F), pressure = -material.lame_lambda * missing;
    Mat3 normal = Mat3::Zero();
    if (missing > 0) normal = material.lame_lambda * cof * cof.transpose();
    for (Index k = 0; k < 3; ++k) {
        const Index i = (k + 1) % 3, j = (k + 2) % 3;
        normal(i, j) += pressure * s[k];
        normal(j, i) += pressure * s[k];
    }
    return without_softening(frames, normal, -pressure * s, pressure * s);
}

}  // namespace skerry
