// Step of the Maxwell elements of a block: springs in series with dashpots (docs/methods/elasticity.md 6.2).
//
// Strains are computed and stored in single precision: their rounding errors, 6e-8 of the strains, are negligible in
// the stress. The loop over strain components contains the loop over springs; both are unrolled. Each sum is updated as
// soon as a component is known, so that few components must be kept in registers.
#pragma once

#ifdef __AVX512VL__
#include <immintrin.h>
#endif

#include <array>
#include <cmath>

#include "components/computed_here.h"
#include "components/element_table.h"
#include "components/lanes.h"
#include "components/prefetch_lines.h"
#include "systems/material/relaxation.h"

namespace skerry {

/// Number of strain components in one vector of type KernelFloat: two with 512-bit registers, else one. Each component
/// takes eight lanes, one for each element of a block.
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

// The functions below sum in an order that does not depend on the register width, so results are bitwise equal for all
// widths. Halves of 512-bit registers are moved with intrinsics, because gcc shuffles the whole register for
// __builtin_shufflevector.
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
/// Accumulates the trace of a matrix. add() takes the vectors of components one after the other.
struct TraceSum {
    Float8 sum;

    [[gnu::always_inline]] void add(std::size_t i, const KernelFloat& component) {
        if (i == 0) sum = first_of(component) + second_of(component);
        if (i == 1) sum = computed_here(sum + first_of(component));
    }
};
/// Accumulates the inner product of two matrices. add() takes the products of their components one vector after the
/// other.
struct InnerProduct {
    KernelFloat sum;

    [[gnu::always_inline]] void add(std::size_t i, const KernelFloat& product) {
        const Float8 one = Float8{} + 1.0F;
        if (i == 0) sum = product;
        if (i == 1) sum = computed_here(sum + together(one, one + one) * product);
        if (i == 2) sum = computed_here(sum + 2.0F * product);
    }
    [[gnu::always_inline]] Float8 total() const { return first_of(sum) + second_of(sum); }
};
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
/// Accumulates the trace of a matrix. add() takes the vectors of components one after the other.
struct TraceSum {
    Float8 sum;

    [[gnu::always_inline]] void add(std::size_t i, const Float8& component) {
        if (i < 3) sum = i == 0 ? component : computed_here(sum + component);
    }
};
/// Accumulates the inner product of two matrices. add() takes the products of their components one vector after the
/// other.
struct InnerProduct {
    Float8 even, odd;

    [[gnu::always_inline]] void add(std::size_t i, const Float8& product) {
        Float8& sum = i % 2 == 0 ? even : odd;
        sum = computed_here(i < 2 ? product : sum + (i < 3 ? product : 2.0F * product));
    }
    [[gnu::always_inline]] Float8 total() const { return even + odd; }
};
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

/// Constants of a step that are equal in all elements of a body. Each is repeated in all lanes of a register, so that
/// arithmetic instructions can take it directly from memory as an operand. Moduli are divided by `modulus`.
struct MaxwellStep {
    // fraction 1 / (1 + h r) of the spring strain that remains after a step of length h, with the relaxation rate r
    std::array<KernelFloat, maxwell_count> kept;
    // h r: strain change of the dashpot in the step, divided by the remaining spring strain
    std::array<Float8, maxwell_count> relaxes;
    Float8 shear, trace, bulk;  // ViscousModuli mu, lambda / 2 and bulk / 2, divided by `modulus`
    Real modulus;               // reference modulus: mu + |lambda| of the material [Pa]

    MaxwellStep(const MaterialConstants& material, const RelaxationRates& rates, Real share, Real h)
        : modulus(material.shear_modulus + std::abs(material.lame_lambda)) {
        for (std::size_t k = 0; k < maxwell_count; ++k) {
            relaxes[k] = Float8{} + static_cast<float>(h * rates[k]);
            kept[k] = KernelFloat{} + static_cast<float>(1 / (1 + h * rates[k]));
        }
        const ViscousModuli moduli = viscous_moduli(material, share);
        // Elements that have only the volumetric part of the stress have the modulus 0 if Poisson's ratio is 0. Their
        // moduli are then 0 instead of 0 / 0.
        const auto relative = [this](Real value) {
            return Float8{} + (modulus > 0 ? static_cast<float>(value / modulus) : 0);
        };
        shear = relative(moduli.mu);
        trace = relative(moduli.lambda / 2);
        bulk = relative(moduli.bulk / 2);
    }
};

/// Relaxes the springs of a block by backward Euler. Returns the second Piola-Kirchhoff stress of all springs, divided
/// by step.modulus.
/// - `strain`: twice Green's strain in this step.
/// - `relaxes_volume`: step length times the relaxation rate of the bulk viscosity.
/// - `last`: strains of the springs in the last step; `next` receives those of this step.
/// - `ahead`: number of blocks from this one to the block whose spring strains are prefetched.
/// - `dissipated`: receives the energy per rest volume that the dashpots have dissipated since the last step, divided
///   by step.modulus / 4. It is the mean of the spring stresses in the last step and in this step, times the strain
///   change of the dashpots.
[[gnu::always_inline]] inline LaneSymmetric<Float8> relax(const MaxwellStep& step, const LaneSymmetric<Float8>& strain,
                                                          const Float8& relaxes_volume, const SpringStrain& last,
                                                          SpringStrain& next, std::size_t ahead, Float8& dissipated) {
    // Prefetches are spread over the function, because processors have few buffers for outstanding cache misses.
    const std::size_t entries_ahead = ahead * last.size();
    constexpr std::size_t entries_per_line = 2;
    const auto prefetch = [&](const SpringStrain& column, std::size_t entry) __attribute__((always_inline)) {
        if (entry % entries_per_line == 0) prefetch_lines_ahead(&column[entry], entries_ahead, entries_per_line);
    };
    // Vector i (of `components_together` components) of the matrix that begins at the given entry.
    const auto load = [&](std::size_t entry, std::size_t i) __attribute__((always_inline)) {
        prefetch(last, entry + i * components_together);
        return reinterpret_cast<const KernelFloatInMemory*>(&last[entry])[i];
    };
    const auto store = [&](const KernelFloat& from, std::size_t entry, std::size_t i) __attribute__((always_inline)) {
        prefetch(next, entry + i * components_together);
        reinterpret_cast<KernelFloatInMemory*>(&next[entry])[i] = from;
    };
    const SixFloats now = six_of(strain);
    SixFloats sum;
    TraceSum trace_of_change;
    std::array<TraceSum, maxwell_count> trace_of_after, trace_of_mean;
    std::array<InnerProduct, maxwell_count> work;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < SixFloats::count; ++i) {
        const KernelFloat change = now.of[i] - load(0, i);
        store(now.of[i], 0, i);
        trace_of_change.add(i, change);
#pragma GCC unroll 3
        for (std::size_t k = 0; k < maxwell_count; ++k) {
            const KernelFloat before = load(6 + 6 * k, i), after = step.kept[k] * (before + change),
                              twice_mean = before + after;
            store(after, 6 + 6 * k, i);
            work[k].add(i, twice_mean * after);
            trace_of_mean[k].add(i, twice_mean);
            trace_of_after[k].add(i, after);
            sum.of[i] = k == 0 ? after : computed_here(sum.of[i] + after);
        }
    }
#pragma GCC unroll 3
    for (std::size_t k = 0; k < maxwell_count; ++k) {
        const Float8 energy = step.relaxes[k] * (step.shear * work[k].total() +
                                                 step.trace * (trace_of_mean[k].sum * trace_of_after[k].sum));
        dissipated = k == 0 ? energy : dissipated + energy;
    }
    prefetch_lines_ahead(&last[bulk_entry], entries_ahead, 1);
    prefetch_lines_ahead(&next[bulk_entry], entries_ahead, 1);
    const Float8 before = *reinterpret_cast<const Float8InMemory*>(last[bulk_entry].lane),
                 after = (before + trace_of_change.sum) / (1.0F + relaxes_volume);
    *reinterpret_cast<Float8InMemory*>(next[bulk_entry].lane) = after;
    dissipated = dissipated + relaxes_volume * (step.bulk * ((before + after) * after));
    const LaneSymmetric<Float8> springs = components_of(sum);
    const Float8 pressure = step.trace * springs.trace() + step.bulk * after;
    LaneSymmetric<Float8> stress = step.shear * springs;
    stress.xx += pressure;
    stress.yy += pressure;
    stress.zz += pressure;
    return stress;
}

}  // namespace skerry
