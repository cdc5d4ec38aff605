// Viscous stress of implicit elements (docs/methods/clusters.md 2).
#pragma once

#include "systems/material/lane_math.h"

namespace skerry {

template <class T>
[[gnu::always_inline]] inline LaneMat3<T> transposed(const LaneMat3<T>& a) {
    return {{a.c0.x, a.c1.x, a.c2.x}, {a.c0.y, a.c1.y, a.c2.y}, {a.c0.z, a.c1.z, a.c2.z}};
}

/// Viscous stress of implicit elements: viscosity/|F|^2 F E', where F' is the rate of F, and E' = (F^T F' + F'^T F) / 2
/// the rate of Green's strain. Its norm is at most viscosity |F'|; the stability of steps relies on this bound.
///
/// The stress is zero in rigid motion. It exerts no torque, because F E' F^T is symmetric.
template <class T>
LaneMat3<T> viscous_stress(const T& viscosity, const LaneMat3<T>& F, const LaneMat3<T>& F_rate) {
    constexpr Real tiny = 1e-6;  // keeps the division finite for |F| = 0 and for unused lanes
    const LaneMat3<T> product = multiply(transposed(F), F_rate);
    const T scale = viscosity / (2.0 * inner_product(F, F) + tiny);
    return multiply(F, scale * (product + transposed(product)));
}

}  // namespace skerry
