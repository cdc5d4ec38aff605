// Relaxing part of the stress, given by Maxwell elements: losses that hardly depend on frequency, and bulk viscosity
// (docs/methods/elasticity.md 6).
#pragma once

#include <cmath>
#include <numbers>

#include "components/element_table.h"
#include "components/material_table.h"
#include "systems/material/lane_math.h"

namespace skerry {

/// A symmetric 3x3 matrix of T.
template <class T>
struct LaneSymmetric {
    T xx, yy, zz, xy, yz, zx;

    T trace() const { return xx + yy + zz; }
};

template <class T>
[[gnu::always_inline]] inline LaneSymmetric<T> operator-(const LaneSymmetric<T>& a, const LaneSymmetric<T>& b) {
    return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx};
}
template <class T>
[[gnu::always_inline]] inline LaneSymmetric<T> operator*(const T& s, const LaneSymmetric<T>& a) {
    return {s * a.xx, s * a.yy, s * a.zz, s * a.xy, s * a.yz, s * a.zx};
}
template <class T>
[[gnu::always_inline]] inline T inner_product(const LaneSymmetric<T>& a, const LaneSymmetric<T>& b) {
    return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2.0 * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}

/// Twice Green's strain: F^T F - I. Rotations do not change this strain. All viscous strains are stored doubled, so
/// that no strain has to be halved.
template <class T>
[[gnu::always_inline]] inline LaneSymmetric<T> twice_green_strain(const LaneMat3<T>& F) {
    return {dot(F.c0, F.c0) - 1.0, dot(F.c1, F.c1) - 1.0, dot(F.c2, F.c2) - 1.0,
            dot(F.c0, F.c1),       dot(F.c1, F.c2),       dot(F.c2, F.c0)};
}

template <class T>
[[gnu::always_inline]] inline LaneMat3<T> multiply(const LaneMat3<T>& F, const LaneSymmetric<T>& S) {
    return {S.xx * F.c0 + S.xy * F.c1 + S.zx * F.c2, S.xy * F.c0 + S.yy * F.c1 + S.yz * F.c2,
            S.zx * F.c0 + S.yz * F.c1 + S.zz * F.c2};
}

/// First Piola-Kirchhoff stress F S + P, where S is a second Piola-Kirchhoff stress and P the stress of a material law.
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> multiply_and_add(const LaneMat3<T>& F, const LaneSymmetric<T>& S,
                                                           const LaneMat3<T>& P) {
    return multiply(F, S) + P;
}
template <class T>
[[gnu::always_inline]] inline LaneMat3<T> multiply_and_add(const LaneMat3<T>& F, LaneSymmetric<T> S,
                                                           const SplitStress<T>& P) {
    S.xx += P.of_F;
    S.yy += P.of_F;
    S.zz += P.of_F;
    return multiply(F, S) + P.of_other * P.other;
}

/// Twice the strain of the springs of the two Maxwell elements. The strain of a spring is the total strain minus the
/// strain of its dashpot.
template <class T>
struct ViscousStretch {
    LaneSymmetric<T> strain;
    T volume;
};

/// Spring stiffnesses of the two Maxwell elements [Pa]. `mu` and `lambda` are the Lame constants of the material, times
/// the ratio relaxing_share; `bulk` acts on the change of volume alone.
struct ViscousModuli {
    Real mu, lambda, bulk;
};

/// Ratio of the lowest frequency of a free body to the lowest relaxation rate. The ratio allows for held bodies: a held
/// end makes the lowest frequency of a beam six times lower.
inline constexpr Real rates_below = 20;

/// Ratio s of the stiffness of the relaxing part to the stiffness of the material law, chosen for a given loss factor
/// at the lowest frequency of a body. Relaxation rates are spread evenly on a logarithmic scale; the highest rate is
/// `span` times the lowest. At the lowest frequency the relaxing part adds a loss modulus of (pi / 2) s / log(span) and
/// a storage modulus of s log(rates_below) / log(span), both relative to the stiffness of the law.
inline Real relaxing_share(Real loss_factor, Real span) {
    return loss_factor * std::log(span) / (std::numbers::pi / 2 - loss_factor * std::log(rates_below));
}

/// Relaxation time of the bulk viscosity times the highest frequency of the element at rest (own_frequency).
inline constexpr Real bulk_time = 0.5;

inline ViscousModuli viscous_moduli(const MaterialConstants& material, Real relaxing_share) {
    return {relaxing_share * material.shear_modulus, relaxing_share * material.lame_lambda,
            2 * material.bulk_viscosity / bulk_time * (material.lame_lambda + 2 * material.shear_modulus)};
}

/// Elastic energy density of the springs of all Maxwell elements [J/m^3].
template <class T>
[[gnu::always_inline]] inline T energy_density(const ViscousModuli& moduli, const ViscousStretch<T>& stretch) {
    const T trace = stretch.strain.trace();
    return 0.125 * ((2 * moduli.mu) * inner_product(stretch.strain, stretch.strain) + moduli.lambda * (trace * trace) +
                    moduli.bulk * (stretch.volume * stretch.volume));
}

/// Second Piola-Kirchhoff stress of the springs, times `scale` [Pa].
template <class T>
[[gnu::always_inline]] inline LaneSymmetric<T> stress(const ViscousModuli& moduli, const ViscousStretch<T>& stretch,
                                                      const T& scale) {
    LaneSymmetric<T> S = T(scale * moduli.mu) * stretch.strain;
    const T pressure =
        (scale * (0.5 * moduli.lambda)) * stretch.strain.trace() + (scale * (0.5 * moduli.bulk)) * stretch.volume;
    S.xx += pressure;
    S.yy += pressure;
    S.zz += pressure;
    return S;
}

template <class T>
[[gnu::always_inline]] inline LaneSymmetric<T> stress(const ViscousModuli& moduli, const ViscousStretch<T>& stretch) {
    return stress(moduli, stretch, T{} + 1.0);
}

template <class T>
[[gnu::always_inline]] inline ViscousStretch<T> viscous_stretch(const LaneSymmetric<T>& strain,
                                                                const ElementStrain& forgotten, std::size_t part = 0) {
    const auto old = [&](std::size_t i) { return load_part<T>(forgotten[i], part); };
    return {strain - LaneSymmetric<T>{old(0), old(1), old(2), old(3), old(4), old(5)}, strain.trace() - old(6)};
}

}  // namespace skerry
