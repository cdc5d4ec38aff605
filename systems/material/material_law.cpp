#include "systems/material/material_law.h"

#include <cmath>

#include "components/check.h"
#include "systems/material/corotational.h"
#include "systems/material/linear.h"
#include "systems/material/stable_neo_hookean.h"

namespace skerry {

Real energy_density(const MaterialConstants& material, const Mat3& F) {
    switch (material.model) {
        case MaterialModel::linear:
            return linear::energy_density(material, F);
        case MaterialModel::corotational:
            return corotational::energy_density(material, F);
        case MaterialModel::stable_neo_hookean:
            break;
    }
    return stable_neo_hookean::energy_density(material, F);
}

Mat3 stress(const MaterialConstants& material, const Mat3& F) {
    switch (material.model) {
        case MaterialModel::linear:
            return linear::stress(material, F);
        case MaterialModel::corotational:
            return corotational::stress(material, F);
        case MaterialModel::stable_neo_hookean:
            break;
    }
    return stable_neo_hookean::stress(material, F);
}

Real stiffness_bound(const MaterialConstants& material, const Mat3& F) {
    switch (material.model) {
        case MaterialModel::linear:
            return linear::stiffness_bound(material, F);
        case MaterialModel::corotational:
            return corotational::stiffness_bound(material, F);
        case MaterialModel::stable_neo_hookean:
            break;
    }
    return stable_neo_hookean::stiffness_bound(material, F);
}

Real pressure_wave_speed(const MaterialConstants& material) {
    return std::sqrt((material.lame_lambda + 2 * material.shear_modulus) / material.density);
}

Real shear_wave_speed(const MaterialConstants& material) {
    return std::sqrt(material.shear_modulus / material.density);
}

Real bar_wave_speed(const MaterialConstants& material) {
    const Real mu = material.shear_modulus, la = material.lame_lambda;
    return std::sqrt(mu * (3 * la + 2 * mu) / ((la + mu) * material.density));
}

MaterialConstants material_constants(MaterialModel model, Real young_modulus, Real poisson_ratio, Real density) {
    SKERRY_CHECK(young_modulus > 0 && density > 0 && poisson_ratio > -1 && poisson_ratio < 0.5);
    return {.model = model,
            .shear_modulus = young_modulus / (2 * (1 + poisson_ratio)),
            .lame_lambda = young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)),
            .density = density};
}

}  // namespace skerry
