// Corotational elasticity: linear in the frame that turns with the element.
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"

namespace skerry::corotational {

/// Elastic energy per rest volume, J/m^3: mu |F - R|^2 + lambda/2 (tr(R^T F) - 3)^2, R the rotation nearest to F.
Real energy_density(const MaterialConstants& material, const Mat3& F);

/// First Piola-Kirchhoff stress, Pa: 2 mu (F - R) + lambda (tr(R^T F) - 3) R (methods.md 5).
Mat3 stress(const MaterialConstants& material, const Mat3& F);

/// Largest eigenvalue of dP/dF, Pa: max(2 mu + 3 lambda, 2 mu + (lambda (tr S - 3) - 2 mu) 2/(s_i + s_j)), s the singular values of F, the
/// smallest with the sign of det F (methods.md 4.2). Infinite where the nearest rotation is not unique.
Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

/// The same by lanes, with the rotation R nearest to F given.
template <class T>
T energy_density(const MaterialConstants& material, const LaneMat3<T>& F, const LaneMat3<T>& R) {
    const LaneMat3<T> strain = F - R;
    const T trace = inner_product(R, strain);
    return material.shear_modulus * inner_product(strain, strain) + (0.5 * material.lame_lambda) * (trace * trace);
}

template <class T>
LaneMat3<T> stress(const MaterialConstants& material, const LaneMat3<T>& F, const LaneMat3<T>& R) {
    const LaneMat3<T> strain = F - R;
    const T pressure = material.lame_lambda * inner_product(R, strain);  // R : (F - R) = tr(R^T F) - 3 without the cancellation
    return (2 * material.shear_modulus) * strain + pressure * R;
}

}  // namespace skerry::corotational
