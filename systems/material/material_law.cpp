#include "systems/material/material_law.h"

#include "components/check.h"
#include "systems/material/with_law.h"

namespace skerry {

Real energy_density(const MaterialConstants& material, const Mat3& F) {
    return with_law(material.model, [&](auto law) { return law.energy_density(material, F); });
}

Mat3 stress(const MaterialConstants& material, const Mat3& F) {
    return with_law(material.model, [&](auto law) { return law.stress(material, F); });
}

Real stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    return with_law(material.model, [&](auto law) { return law.stiffness_bound(material, F); });
}

Tangent tangent(const MaterialConstants& material, const Mat3& F) {
    return with_law(material.model, [&](auto law) { return law.tangent(material, F); });
}

Real small_strain_energy(const MaterialConstants& material, const Mat3& change) {
    return with_law(material.model, [&](auto law) {
        if constexpr (requires { law.energy_of_strain(material, change); })
            return law.energy_of_strain(material, (change + change.transpose()) / 2);
        else
            return Linear::energy_density(material, Mat3::Identity() + change);
    });
}

Mat3 small_strain_stiffness(const MaterialConstants& material, const Vec3& g, const Vec3& other) {
    return with_law(material.model, [&](auto law) -> Mat3 {
        if constexpr (requires { law.dyads(material, Mat3::Identity()); }) {
            Mat3 stiffness = Mat3::Zero();
            for (const Mat3& dyad : law.dyads(material, Mat3::Identity()))
                stiffness += (dyad * g) * (dyad * other).transpose();
            return stiffness;
        } else {
            const Real lambda = material.lame_lambda, mu = material.shear_modulus;
            return lambda * g * other.transpose() + mu * (g.dot(other) * Mat3::Identity() + other * g.transpose());
        }
    });
}

MaterialConstants material_constants(MaterialModel model, Real young_modulus, Real poisson_ratio, Real density) {
    SKERRY_CHECK(young_modulus > 0 && density > 0 && poisson_ratio > -1 && poisson_ratio < 0.5);
    return {.model = model,
            .shear_modulus = young_modulus / (2 * (1 + poisson_ratio)),
            .lame_lambda = young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)),
            .density = density};
}

IsotropicModuli isotropic_moduli(const MaterialConstants& material) {
    const Real mu = material.shear_modulus, sum = material.lame_lambda + mu;
    return {mu * (2 * sum + material.lame_lambda) / sum, material.lame_lambda / (2 * sum)};
}

}  // namespace skerry
