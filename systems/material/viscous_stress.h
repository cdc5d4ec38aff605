// Stress of the strain rate: viscosity of a material, and that of implicit elements (docs/methods/clusters.md 2).
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"

namespace skerry {

template <class T>
[[gnu::always_inline]] inline LaneMat3<T> transposed(const LaneMat3<T>& a) {
    return {{a.c0.x, a.c1.x, a.c2.x}, {a.c0.y, a.c1.y, a.c2.y}, {a.c0.z, a.c1.z, a.c2.z}};
}

/// Stress of the strain rate, F S with S = time (2 mu E' + lambda tr(E') I) and E' = (F^T F' + F'^T F) / 2: nothing in
/// rigid motion, and no torque, since F S F^T is symmetric.
template <class T>
LaneMat3<T> viscous_stress(const MaterialConstants& material, Real time, const LaneMat3<T>& F,
                           const LaneMat3<T>& F_rate) {
    const LaneMat3<T> product = multiply(transposed(F), F_rate);
    LaneMat3<T> S = (time * material.shear_modulus) * (product + transposed(product));
    const T pressure = (time * material.lame_lambda) * (product.c0.x + product.c1.y + product.c2.z);
    S.c0.x += pressure;
    S.c1.y += pressure;
    S.c2.z += pressure;
    return multiply(F, S);
}

/// Stress of the strain rate in implicit elements, F E' viscosity/|F|^2: at most viscosity |F'| however much they are
/// deformed, which their inertia is made for.
template <class T>
LaneMat3<T> bounded_viscous_stress(const T& viscosity, const LaneMat3<T>& F, const LaneMat3<T>& F_rate) {
    constexpr Real tiny = 1e-6;  // |F|^2 of a point, and of lanes that are left over
    const LaneMat3<T> product = multiply(transposed(F), F_rate);
    const T scale = viscosity / (2.0 * inner_product(F, F) + tiny);
    return multiply(F, scale * (product + transposed(product)));
}

}  // namespace skerry
