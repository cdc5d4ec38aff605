#include "systems/material/stable_neo_hookean.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace skerry::stable_neo_hookean {

namespace {

Mat3 cofactor_of(const Mat3& F) {
    Mat3 cof;
    cof.col(0) = F.col(1).cross(F.col(2));
    cof.col(1) = F.col(2).cross(F.col(0));
    cof.col(2) = F.col(0).cross(F.col(1));
    return cof;
}

}  // namespace

Real energy_density(const MaterialConstants& material, const Mat3& F) {
    const Real mu = material.shear_modulus;
    const Real growth = F.determinant() - 1;
    return 0.5 * mu * (F.squaredNorm() - 3) - mu * growth + 0.5 * model_lambda(material) * growth * growth;
}

Mat3 stress(const MaterialConstants& material, const Mat3& F) {
    const Real mu = material.shear_modulus;
    return mu * F + (model_lambda(material) * (F.determinant() - 1) - mu) * cofactor_of(F);
}

Real stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    const Real mu = material.shear_modulus, la = model_lambda(material);
    // The largest root of e^3 - |F|^2 e - 2 J = 0 is at most 2/sqrt(3) |F|.
    return mu + la * cofactor_of(F).squaredNorm() + 2 / std::sqrt(Real{3}) * std::abs(la * (F.determinant() - 1) - mu) * F.norm();
}

}  // namespace skerry::stable_neo_hookean
