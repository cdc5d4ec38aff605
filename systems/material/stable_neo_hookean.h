// Stable neo-Hookean elasticity (Smith 2018) in the short form without the logarithm: finite for every F, inverted or flat.
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"

namespace skerry::stable_neo_hookean {

/// The model's lambda that gives the small-strain moduli: la = lame_lambda + shear_modulus, mu = shear_modulus (methods.md 5).
inline Real model_lambda(const MaterialConstants& material) {
    return material.lame_lambda + material.shear_modulus;
}

/// Elastic energy per rest volume, J/m^3: mu/2 (|F|^2 - 3) - mu (J - 1) + la/2 (J - 1)^2; 0 at rest.
Real energy_density(const MaterialConstants& material, const Mat3& F);

/// First Piola-Kirchhoff stress, Pa: mu F + (la (J - 1) - mu) cof F.
Mat3 stress(const MaterialConstants& material, const Mat3& F);

/// Bound on the largest eigenvalue of dP/dF, Pa: mu + la |cof F|^2 + 2/sqrt(3) |la (J - 1) - mu| |F| (methods.md 4.2).
Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

/// The same by lanes.
template <class T>
T energy_density(const MaterialConstants& material, const LaneMat3<T>& F) {
    const T growth = dot(F.c0, cross(F.c1, F.c2)) - 1.0;
    const T stretch = inner_product(F, F) - 3.0;
    return material.shear_modulus * (0.5 * stretch - growth) + (0.5 * model_lambda(material)) * (growth * growth);
}

template <class T>
LaneMat3<T> stress(const MaterialConstants& material, const LaneMat3<T>& F) {
    const Real mu = material.shear_modulus;
    const LaneMat3<T> cof = cofactor(F);
    const T pressure = model_lambda(material) * (dot(F.c0, cof.c0) - 1.0) - mu;
    return mu * F + pressure * cof;
}

template <class T>
T stiffness_bound(const MaterialConstants& material, const LaneMat3<T>& F) {
    constexpr Real two_over_root_three = 1.1547005383792515;
    const LaneMat3<T> cof = cofactor(F);
    const T slope = model_lambda(material) * (dot(F.c0, cof.c0) - 1.0) - material.shear_modulus;
    return material.shear_modulus + model_lambda(material) * inner_product(cof, cof) +
           two_over_root_three * square_root(slope * slope * inner_product(F, F));
}

}  // namespace skerry::stable_neo_hookean
