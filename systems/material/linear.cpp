#include "systems/material/linear.h"

#include <algorithm>

namespace skerry {

Real Linear::energy_density(const MaterialConstants& material, const Mat3& F) {
    const Mat3 strain = 0.5 * (F + F.transpose()) - Mat3::Identity();
    const Real trace = strain.trace();
    return material.shear_modulus * strain.squaredNorm() + 0.5 * material.lame_lambda * trace * trace;
}

Mat3 Linear::stress(const MaterialConstants& material, const Mat3& F) {
    return material.shear_modulus * (F + F.transpose() - 2 * Mat3::Identity()) +
           material.lame_lambda * (F.trace() - 3) * Mat3::Identity();
}

Real Linear::stiffness_bound(const MaterialConstants& material, const Mat3&) {
    // For auxetic materials lambda is negative, and 2 mu is the largest eigenvalue.
    return 2 * material.shear_modulus + std::max(Real{0}, 3 * material.lame_lambda);
}

Tangent Linear::tangent(const MaterialConstants& material, const Mat3&) {
    const Real mu = material.shear_modulus;
    const Mat3 normal = 2 * mu * Mat3::Identity() + Mat3::Constant(material.lame_lambda);
    return {Mat3::Identity(), Mat3::Identity(), normal, Vec3::Constant(2 * mu), Vec3::Zero()};
}

}  // namespace skerry
