// Step of the Maxwell elements of a block: springs in series with dashpots (docs/methods/elasticity.md 6.2). Strains
// are computed and stored in single precision. Their rounding errors, 6e-8 of the strains, are negligible in the
// stress. Loops over components are unrolled, so that the components stay in registers.
#pragma once

#ifdef __AVX512VL__
#include <immintrin.h>
#endif

#include <array>
#include <cmath>

#include "components/element_table.h"
#include "components/lanes.h"
#include "components/prefetch_lines.h"
#include "systems/material/relaxation.h"

namespace skerry {

/// Number of strain components in one vector of type KernelFloat: two with 512-bit registers, else one.
#ifdef __AVX512VL__
inline constexpr std::size_t components_together = 2;
#else
inline constexpr std::size_t components_together = 1;
#endif
typedef float KernelFloat __attribute__((vector_size(components_together * sizeof(Float8))));
typedef float KernelFloatInMemory
    __attribute__((vector_size(sizeof(KernelFloat)), aligned(alignof(Float8)), may_alias));

/// The six components of a symmetric matrix in the order xx, yy, zz, xy, yz, zx, for all lanes of a block.
struct SixFloats {
    static constexpr std::size_t count = 6 / components_together;
    KernelFloat of[count];
};

[[gnu::always_inline]] inline SixFloats load_six(const Lanes<float, element_lanes>* from) {
    SixFloats six;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < six.count; ++i) six.of[i] = reinterpret_cast<const KernelFloatInMemory*>(from)[i];
    return six;
}
[[gnu::always_inline]] inline void store_six(const SixFloats& six, Lanes<float, element_lanes>* to) {
#pragma GCC unroll 6
    for (std::size_t i = 0; i < six.count; ++i) reinterpret_cast<KernelFloatInMemory*>(to)[i] = six.of[i];
}

[[gnu::always_inline]] inline SixFloats operator+(const SixFloats& a, const SixFloats& b) {
    SixFloats sum;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < sum.count; ++i) sum.of[i] = a.of[i] + b.of[i];
    return sum;
}
[[gnu::always_inline]] inline SixFloats operator-(const SixFloats& a, const SixFloats& b) {
    SixFloats difference;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < difference.count; ++i) difference.of[i] = a.of[i] - b.of[i];
    return difference;
}
[[gnu::always_inline]] inline SixFloats operator*(float s, const SixFloats& a) {
    SixFloats product;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < product.count; ++i) product.of[i] = s * a.of[i];
    return product;
}

// The functions below sum in an order that does not depend on the register width. Halves of 512-bit registers are moved
// with intrinsics, because gcc shuffles the whole register for __builtin_shufflevector.
#ifdef __AVX512VL__
[[gnu::always_inline]] inline KernelFloat together(const Float8& a, const Float8& b) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(a), b, 1);
}
[[gnu::always_inline]] inline Float8 first_of(const KernelFloat& pair) {
    return _mm512_castps512_ps256(pair);
}
[[gnu::always_inline]] inline Float8 second_of(const KernelFloat& pair) {
    return _mm512_extractf32x8_ps(pair, 1);
}
[[gnu::always_inline]] inline LaneSymmetric<Float8> components_of(const SixFloats& six) {
    return {first_of(six.of[0]),  second_of(six.of[0]), first_of(six.of[1]),
            second_of(six.of[1]), first_of(six.of[2]),  second_of(six.of[2])};
}
[[gnu::always_inline]] inline SixFloats six_of(const LaneSymmetric<Float8>& a) {
    return {{together(a.xx, a.yy), together(a.zz, a.xy), together(a.yz, a.zx)}};
}
[[gnu::always_inline]] inline Float8 trace(const SixFloats& a) {
    return (first_of(a.of[0]) + second_of(a.of[0])) + first_of(a.of[1]);
}
[[gnu::always_inline]] inline Float8 inner_product(const SixFloats& a, const SixFloats& b) {
    const Float8 one = Float8{} + 1.0F;
    const KernelFloat sum =
        (a.of[0] * b.of[0] + together(one, one + one) * (a.of[1] * b.of[1])) + 2.0F * (a.of[2] * b.of[2]);
    return first_of(sum) + second_of(sum);
}
[[gnu::always_inline]] inline Float8 floats_of(const Parts<Real8>& reals) {
    return __builtin_convertvector(reals[0], Float8);
}
[[gnu::always_inline]] inline Real8 part_of(const Float8& floats, std::size_t) {
    return _mm512_cvtps_pd(floats);
}
#else
[[gnu::always_inline]] inline LaneSymmetric<Float8> components_of(const SixFloats& six) {
    return {six.of[0], six.of[1], six.of[2], six.of[3], six.of[4], six.of[5]};
}
[[gnu::always_inline]] inline SixFloats six_of(const LaneSymmetric<Float8>& a) {
    return {{a.xx, a.yy, a.zz, a.xy, a.yz, a.zx}};
}
[[gnu::always_inline]] inline Float8 trace(const SixFloats& a) {
    return (a.of[0] + a.of[1]) + a.of[2];
}
[[gnu::always_inline]] inline Float8 inner_product(const SixFloats& a, const SixFloats& b) {
    const Float8 even = (a.of[0] * b.of[0] + a.of[2] * b.of[2]) + 2.0F * (a.of[4] * b.of[4]);
    const Float8 odd = (a.of[1] * b.of[1] + 2.0F * (a.of[3] * b.of[3])) + 2.0F * (a.of[5] * b.of[5]);
    return even + odd;
}
[[gnu::always_inline]] inline Float8 floats_of(const Parts<Real4>& reals) {
    return __builtin_convertvector(__builtin_shufflevector(reals[0], reals[1], 0, 1, 2, 3, 4, 5, 6, 7), Float8);
}
[[gnu::always_inline]] inline Real4 part_of(const Float8& floats, std::size_t part) {
    const Real8 all = __builtin_convertvector(floats, Real8);
    return part == 0 ? __builtin_shufflevector(all, all, 0, 1, 2, 3) : __builtin_shufflevector(all, all, 4, 5, 6, 7);
}
#endif
[[gnu::always_inline]] inline LaneSymmetric<KernelReal> part_of(const LaneSymmetric<Float8>& a, std::size_t part) {
    return {part_of(a.xx, part), part_of(a.yy, part), part_of(a.zz, part),
            part_of(a.xy, part), part_of(a.yz, part), part_of(a.zx, part)};
}

/// Constants of a step that are equal in all elements of a body. Moduli are divided by `modulus`.
struct MaxwellStep {
    // fraction 1 / (1 + h r) of the spring strain that remains after a step h at the rate r
    std::array<float, maxwell_count> kept;
    // h r: strain change of the dashpot in the step, divided by the remaining spring strain
    std::array<float, maxwell_count> relaxes;
    float shear, trace, bulk;  // ViscousModuli mu, lambda / 2 and bulk / 2, divided by `modulus`
    Real modulus;              // reference modulus: mu + |lambda| of the material [Pa]

    MaxwellStep(const MaterialConstants& material, const RelaxationRates& rates, Real share, Real h)
        : modulus(material.shear_modulus + std::abs(material.lame_lambda)) {
        for (std::size_t k = 0; k < maxwell_count; ++k) {
            relaxes[k] = static_cast<float>(h * rates[k]);
            kept[k] = static_cast<float>(1 / (1 + h * rates[k]));
        }
        const ViscousModuli moduli = viscous_moduli(material, share);
        // Elements that have only the volumetric part of the stress have the modulus 0 if Poisson's ratio is 0. Their
        // moduli are then 0 instead of 0 / 0.
        const auto relative = [this](Real of) { return modulus > 0 ? static_cast<float>(of / modulus) : 0; };
        shear = relative(moduli.mu);
        trace = relative(moduli.lambda / 2);
        bulk = relative(moduli.bulk / 2);
    }
};

/// Relaxes the springs of a block by backward Euler. `strain`: twice Green's strain in this step. `relaxes_volume`:
/// step length times the rate of the bulk viscosity. `last`: springs in the last step; `next` receives those of this
/// step. Returns the second Piola-Kirchhoff stress of all springs, divided by step.modulus. Springs of the block that
/// comes `ahead` blocks later are prefetched.
///
/// The dashpots dissipate, per volume, the mean of the spring stresses in the last and this step, times the strain
/// change of the dashpots. `dissipated` receives this energy density since the last step, divided by a quarter of
/// step.modulus.
[[gnu::always_inline]] inline LaneSymmetric<Float8> relax(const MaxwellStep& step, const LaneSymmetric<Float8>& strain,
                                                          const Float8& relaxes_volume, const SpringStrain& last,
                                                          SpringStrain& next, std::size_t ahead, Float8& dissipated) {
    // Prefetches are spread over the function, because processors have few buffers for outstanding cache misses.
    const std::size_t entries_ahead = ahead * last.size();
    const auto load = [&](std::size_t entry) __attribute__((always_inline)) {
        prefetch_lines_ahead(&last[entry], entries_ahead, 6);
        return load_six(&last[entry]);
    };
    const auto store = [&](const SixFloats& six, std::size_t entry) __attribute__((always_inline)) {
        prefetch_lines_ahead(&next[entry], entries_ahead, 6);
        store_six(six, &next[entry]);
    };
    const SixFloats now = six_of(strain), change = now - load(0);
    store(now, 0);
    const auto spring = [&](std::size_t k, Float8 & energy) __attribute__((always_inline)) {
        const SixFloats before = load(6 + 6 * k), after = step.kept[k] * (before + change), twice_mean = before + after;
        store(after, 6 + 6 * k);
        energy = step.relaxes[k] * (step.shear * inner_product(twice_mean, after) +
                                    step.trace * (skerry::trace(twice_mean) * skerry::trace(after)));
        return after;
    };
    SixFloats sum = spring(0, dissipated);
#pragma GCC unroll 3
    for (std::size_t k = 1; k < maxwell_count; ++k) {
        Float8 energy;
        sum = sum + spring(k, energy);
        dissipated = dissipated + energy;
    }
    prefetch_lines_ahead(&last[bulk_entry], entries_ahead, 1);
    prefetch_lines_ahead(&next[bulk_entry], entries_ahead, 1);
    const Float8 before = *reinterpret_cast<const Float8InMemory*>(last[bulk_entry].lane),
                 after = (before + skerry::trace(change)) / (1.0F + relaxes_volume);
    *reinterpret_cast<Float8InMemory*>(next[bulk_entry].lane) = after;
    dissipated = dissipated + relaxes_volume * (step.bulk * ((before + after) * after));
    const Float8 pressure = step.trace * skerry::trace(sum) + step.bulk * after;
    LaneSymmetric<Float8> stress = components_of(step.shear * sum);
    stress.xx += pressure;
    stress.yy += pressure;
    stress.zz += pressure;
    return stress;
}

}  // namespace skerry
