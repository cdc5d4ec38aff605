#include "systems/material/stable_neo_hookean.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace skerry {

namespace {

Mat3 cofactor_of(const Mat3& F) {
    Mat3 cof;
    cof.col(0) = F.col(1).cross(F.col(2));
    cof.col(1) = F.col(2).cross(F.col(0));
    cof.col(2) = F.col(0).cross(F.col(1));
    return cof;
}

}  // namespace

Real StableNeoHookean::energy_density(const MaterialConstants& material, const Mat3& F) {
    const auto [mu, la] = model_moduli(material);
    // Computes the energy from e = F - I without the first-order terms, which cancel. With these terms a body in its
    // rest shape would have the energy of their rounding errors.
    const Mat3 e = F - Mat3::Identity();
    const Real trace = e.trace(), bulk = (trace * trace - e.cwiseProduct(e.transpose()).sum()) / 2 + e.determinant();
    const Real growth = trace + bulk, quarter = (2 * trace + e.squaredNorm()) / 4;
    return mu * (0.375 * e.squaredNorm() - 0.75 * bulk - 0.5 * (std::log1p(quarter) - quarter)) +
           0.5 * la * growth * growth;
}

Mat3 StableNeoHookean::stress(const MaterialConstants& material, const Mat3& F) {
    const auto [mu, la] = model_moduli(material);
    return mu * (1 - 1 / (F.squaredNorm() + 1)) * F + (la * (F.determinant() - 1) - 0.75 * mu) * cofactor_of(F);
}

Real StableNeoHookean::stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    const auto [mu, la] = model_moduli(material);
    // The largest eigenvalue of d(cof F)/dF is the largest root e of e^3 - |F|^2 e - 2 J = 0, with J = det F. It is at
    // most 2/sqrt(3) |F|.
    return 1.125 * mu + la * cofactor_of(F).squaredNorm() +
           2 / std::sqrt(Real{3}) * std::abs(la * (F.determinant() - 1) - 0.75 * mu) * F.norm();
}

Tangent StableNeoHookean::tangent(const MaterialConstants& material, const Mat3& F) {
    const auto [mu, la] = model_moduli(material);
    const Stretches frames(F);
    const Vec3& s = frames.stretch;
    const Vec3 cof(s[1] * s[2], s[2] * s[0], s[0] * s[1]);
    const Real inverse = 1 / (s.squaredNorm() + 1), shear = mu - mu * inverse;
    const Real pressure = la * (s.prod() - 1) - 0.75 * mu;
    Mat3 normal =
        shear * Mat3::Identity() + 2 * mu * inverse * inverse * s * s.transpose() + la * cof * cof.transpose();
    for (Index k = 0; k < 3; ++k) {
        const Index i = (k + 1) % 3, j = (k + 2) % 3;
        normal(i, j) += pressure * s[k];
        normal(j, i) += pressure * s[k];
    }
    return without_softening(frames, normal, Vec3::Constant(shear) - pressure * s,
                             Vec3::Constant(shear) + pressure * s);
}

}  // namespace skerry
