#include "systems/material/corotational.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

namespace skerry {

namespace {

/// F = R S with R a rotation: from the singular values, the smallest turned round when F is mirrored. Shares nothing
/// with the kernel.
struct Polar {
    Mat3 R;
    Vec3 stretch;
};

Polar polar(const Mat3& F) {
    const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 U = svd.matrixU();
    Vec3 s = svd.singularValues();
    if ((U * svd.matrixV().transpose()).determinant() < 0) {
        U.col(2) *= -1;
        s[2] *= -1;
    }
    return {U * svd.matrixV().transpose(), s};
}

}  // namespace

Real Corotational::energy_density(const MaterialConstants& material, const Mat3& F) {
    const Vec3 strain = polar(F).stretch - Vec3::Ones();
    return material.shear_modulus * strain.squaredNorm() + 0.5 * material.lame_lambda * strain.sum() * strain.sum();
}

Mat3 Corotational::stress(const MaterialConstants& material, const Mat3& F) {
    const Polar p = polar(F);
    return 2 * material.shear_modulus * (F - p.R) + material.lame_lambda * (p.stretch.sum() - 3) * p.R;
}

Real Corotational::stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    const Real mu = material.shear_modulus, la = material.lame_lambda;
    const Vec3 s = polar(F).stretch;
    const Real twist = la * (s.sum() - 3) - 2 * mu;
    // dP/dF = 2 mu on every deviatoric mode, 2 mu + 3 la on R itself; the modes that turn R add twist * 2/(s_i + s_j).
    Real bound = 2 * mu + std::max(Real{0}, 3 * la);
    if (twist > 0) bound = std::max(bound, 2 * mu + twist * 2 / std::max(s[1] + s[2], Real{0}));
    return bound;
}

}  // namespace skerry
