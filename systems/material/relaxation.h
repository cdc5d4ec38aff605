// Part of the stress that relaxes, given by Maxwell elements: springs in series with dashpots. It causes losses that
// hardly depend on frequency, and the bulk viscosity (docs/methods/elasticity.md 6).
#pragma once

#include <array>
#include <cmath>
#include <complex>

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
[[gnu::always_inline]] inline LaneSymmetric<T> operator+(const LaneSymmetric<T>& a, const LaneSymmetric<T>& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
}
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

/// Twice Green's strain: F^T F - I. Rotations do not change this strain. All strains of springs are stored doubled, so
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

/// Doubled spring strains, summed over all Maxwell elements: the stress of the springs depends only on these sums.
/// `volume`: doubled volume strain of the spring of the bulk viscosity.
template <class T>
struct ViscousStretch {
    LaneSymmetric<T> strain;
    T volume;
};

/// Doubled strains of the springs of the Maxwell elements. The strain of a spring is the total strain minus the strain
/// of its dashpot.
template <class T>
struct MaxwellSprings {
    std::array<LaneSymmetric<T>, maxwell_count> strain;
    T volume;

    ViscousStretch<T> sum() const {
        ViscousStretch<T> sum{strain[0], volume};
        for (std::size_t k = 1; k < maxwell_count; ++k) sum.strain = sum.strain + strain[k];
        return sum;
    }
};

/// Stiffnesses of the springs of the Maxwell elements [Pa]. Each of the maxwell_count equal springs has the Lame
/// constants `mu` and `lambda`: those of the material times the ratio relaxing_share. `bulk`: stiffness of the spring
/// of the bulk viscosity, which resists only changes of volume.
struct ViscousModuli {
    Real mu, lambda, bulk;
};

/// Ratio of the lowest frequency of a free body to the lower end of the band of relaxation rates. Bodies may be held,
/// and a held end makes the lowest frequency of a beam six times lower. With the ratio 12 the band contains it, too.
inline constexpr Real rates_below = 12;

/// Relaxation rates of the Maxwell elements [1/s]. The band from `highest / span` to `highest` is divided into equal
/// sections on a logarithmic scale; each rate is the middle of a section.
inline RelaxationRates relaxation_rates(Real highest, Real span) {
    RelaxationRates rates;
    for (std::size_t k = 0; k < maxwell_count; ++k)
        rates[k] = highest * std::pow(span, -(static_cast<Real>(k) + 0.5) / maxwell_count);
    return rates;
}

/// Ratio of the stiffness of each spring to the stiffness of the material law. With it, a body that vibrates freely at
/// its lowest frequency has the given loss factor eta: its amplitude falls by the factor exp(-pi eta) in a period. The
/// lowest frequency is taken to be rates_below times the lower end of the band of rates.
///
/// Derivation for a mode with the motion exp(z t), where z = omega (i - eta/2):
/// - The mode needs the stiffness -z^2 times its mass.
/// - A Maxwell element of rate r and share 1 adds the fraction z / (z + r) to the stiffness of the law.
/// - Stiffness needed and stiffness present must have the same ratio of imaginary to real part.
inline Real relaxing_share(Real loss_factor, Real span) {
    const std::complex<Real> z = rates_below * std::complex<Real>(-loss_factor / 2, 1), needed = -z * z;
    std::complex<Real> added = 0;
    for (const Real rate : relaxation_rates(span, span)) added += z / (z + rate);
    const Real slope = needed.imag() / needed.real();
    return slope / (added.imag() - slope * added.real());
}

/// Effective number of springs in the stability bound for steps of length `step` [s]. A spring that relaxes at the rate
/// r counts as 2 / (2 + step r), because it relaxes within the step (docs/methods/elasticity.md 6.2).
inline Real8 springs_that_count(const RelaxationRates& rates, const Real8& step) {
    Real8 count{};
    for (const Real rate : rates) count += 2.0 / (2.0 + step * rate);
    return count;
}

/// Relaxation time of the bulk viscosity, times the highest circular frequency of the element at rest (own_frequency).
inline constexpr Real bulk_time = 0.5;

inline ViscousModuli viscous_moduli(const MaterialConstants& material, Real relaxing_share) {
    return {relaxing_share * material.shear_modulus, relaxing_share * material.lame_lambda,
            2 * material.bulk_viscosity / bulk_time * (material.lame_lambda + 2 * material.shear_modulus)};
}

/// Elastic energy density of the springs of all Maxwell elements [J/m^3].
template <class T>
T energy_density(const ViscousModuli& moduli, const MaxwellSprings<T>& springs) {
    T sum = moduli.bulk * (springs.volume * springs.volume);
    for (const LaneSymmetric<T>& strain : springs.strain)
        sum = sum + (2 * moduli.mu) * inner_product(strain, strain) + moduli.lambda * (strain.trace() * strain.trace());
    return 0.125 * sum;
}

/// Second Piola-Kirchhoff stress of the springs [Pa].
template <class T>
LaneSymmetric<T> stress(const ViscousModuli& moduli, const ViscousStretch<T>& stretch) {
    LaneSymmetric<T> S = T(T{} + moduli.mu) * stretch.strain;
    const T pressure = 0.5 * moduli.lambda * stretch.strain.trace() + 0.5 * moduli.bulk * stretch.volume;
    S.xx += pressure;
    S.yy += pressure;
    S.zz += pressure;
    return S;
}

/// Doubled strains of the springs of a block in its present shape, if the dashpots do not move from their last state.
/// `strain`: twice Green's strain in the present shape.
inline MaxwellSprings<Real8> springs_in(const LaneSymmetric<Real8>& strain, const SpringStrain& last) {
    const auto six_from = [&](std::size_t i) {
        return LaneSymmetric<Real8>{load_reals(last[i]),     load_reals(last[i + 1]), load_reals(last[i + 2]),
                                    load_reals(last[i + 3]), load_reals(last[i + 4]), load_reals(last[i + 5])};
    };
    const LaneSymmetric<Real8> change = strain - six_from(0);
    MaxwellSprings<Real8> springs;
    for (std::size_t k = 0; k < maxwell_count; ++k) springs.strain[k] = six_from(6 + 6 * k) + change;
    springs.volume = load_reals(last[bulk_entry]) + change.trace();
    return springs;
}

}  // namespace skerry
