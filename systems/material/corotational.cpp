#include "systems/material/corotational.h"

#include <algorithm>

namespace skerry {

Real Corotational::energy_density(const MaterialConstants& material, const Mat3& F) {
    const Vec3 strain = Stretches(F).stretch - Vec3::Ones();
    return material.shear_modulus * strain.squaredNorm() + 0.5 * material.lame_lambda * strain.sum() * strain.sum();
}

Mat3 Corotational::stress(const MaterialConstants& material, const Mat3& F) {
    const Stretches frames(F);
    const Mat3 R = frames.left * frames.right.transpose();
    return 2 * material.shear_modulus * (F - R) + material.lame_lambda * (frames.stretch.sum() - 3) * R;
}

Real Corotational::stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    const Real mu = material.shear_modulus, la = material.lame_lambda;
    Vec3 s = Stretches(F).stretch;
    std::ranges::sort(s, std::greater<Real>());
    const Real rotation_term = la * (s.sum() - 3) - 2 * mu;
    // Eigenvalues of dP/dF, with the rotation R nearest to F and the stretches s:
    // - 2 mu + 3 la for a change of F along R
    // - 2 mu + rotation_term * 2/(s_i + s_j) for the three changes of F that rotate R
    // - 2 mu for all other changes of F
    Real bound = 2 * mu + std::max(Real{0}, 3 * la);
    if (rotation_term > 0) bound = std::max(bound, 2 * mu + rotation_term * 2 / std::max(s[1] + s[2], Real{0}));
    return bound;
}

Tangent Corotational::tangent(const MaterialConstants& material, const Mat3& F) {
    constexpr Real least = 1e-3;  // lower bound of the sum s_i + s_j of two stretches; R is not unique if a sum is 0
    const Real mu = material.shear_modulus, la = material.lame_lambda;
    const Stretches frames(F);
    const Vec3& s = frames.stretch;
    const Real rotation_term = la * (s.sum() - 3) - 2 * mu;
    Vec3 twist;
    for (Index k = 0; k < 3; ++k)
        twist[k] = 2 * mu + 2 * rotation_term / std::max(s[(k + 1) % 3] + s[(k + 2) % 3], least);
    return without_softening(frames, 2 * mu * Mat3::Identity() + Mat3::Constant(la), Vec3::Constant(2 * mu), twist);
}

}  // namespace skerry
