#include "systems/dynamics/elements/compute_element_forces.h"

#include <algorithm>
#include <numeric>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/relaxation.h"
#include "systems/material/with_law.h"

namespace skerry {

namespace {

constexpr std::size_t blocks_per_job = 64;  // 512 tetrahedra, some 4 us: well above the cost of handing out a job

LaneMat3<Real8> transposed(const LaneMat3<Real8>& a) {
    return {{a.c0.x, a.c1.x, a.c2.x}, {a.c0.y, a.c1.y, a.c2.y}, {a.c0.z, a.c1.z, a.c2.z}};
}

/// Stress of the strain rate, F S with S = time (2 mu E' + lambda tr(E') I) and E' = (F^T F' + F'^T F) / 2: nothing in
/// rigid motion, and no torque, since F S F^T is symmetric.
LaneMat3<Real8> viscous_stress(const MaterialConstants& material, Real time, const LaneMat3<Real8>& F,
                               const LaneMat3<Real8>& F_rate) {
    const LaneMat3<Real8> product = multiply(transposed(F), F_rate);
    LaneMat3<Real8> S = (time * material.shear_modulus) * (product + transposed(product));
    const Real8 pressure = (time * material.lame_lambda) * (product.c0.x + product.c1.y + product.c2.z);
    S.c0.x += pressure;
    S.c1.y += pressure;
    S.c2.z += pressure;
    return multiply(F, S);
}

/// The dashpots give way for `duration` seconds, then the springs push. Returns the stress, Pa, and writes what the
/// dashpots have taken and what they dissipated, J.
[[gnu::always_inline]] inline LaneMat3<Real8> relax(const ViscousModuli& moduli, const LaneMat3<Real8>& F,
                                                    const Real8& volume, const Real8& rate, const Real8& frequency,
                                                    Real duration, const ElementStrain& forgotten,
                                                    ElementStrain& forgotten_next, Real& relaxed) {
    const LaneSymmetric<Real8> strain = green_strain(F);
    const ViscousStretch<Real8> before = viscous_stretch(strain, forgotten);
    // backward Euler: never more than all
    const ViscousStretch<Real8> after{Real8(1.0 / (1.0 + duration * rate)) * before.strain,
                                      before.volume / (1.0 + (duration / bulk_time) * frequency)};
    const LaneSymmetric<Real8> next = strain - after.strain;
    const Real8 all[7] = {next.xx, next.yy, next.zz, next.xy, next.yz, next.zx, strain.trace() - after.volume};
    for (std::size_t i = 0; i < 7; ++i) store(all[i], forgotten_next[i]);
    // What the springs, as stretched as they push, do to the dashpots. Not the drop of their energy: the kick that
    // follows is by so much weaker, which velocities half a step off the positions do not show yet.
    const Real8 lost =
        volume * work_density(moduli, after, {before.strain - after.strain, before.volume - after.volume});
    relaxed = ((lost[0] + lost[4]) + (lost[1] + lost[5])) + ((lost[2] + lost[6]) + (lost[3] + lost[7]));
    return multiply(F, stress(moduli, after));
}

}  // namespace

Real compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, Real h, std::span<const ElementRotation> rotation,
                            const ElementMemory& next, std::span<ElementForces> force) {
    SKERRY_CHECK(force.size() == elements.node.size() && rotation.size() == force.size() &&
                 next.rotation.size() == force.size());
    parallel_for(executor, elements.node.size(), blocks_per_job, [&](std::size_t begin, std::size_t end) {
        if (elements.schedule.none_active(begin, end)) {
            if (!next.relaxed.empty()) std::fill(next.relaxed.begin() + begin, next.relaxed.begin() + end, Real{0});
            return;
        }
        for (std::size_t b = begin; b < end; ++b) {
            const Real duration = elements.schedule.duration(b);
            if (duration == 0) {
                if (!next.relaxed.empty()) next.relaxed[b] = 0;
                continue;
            }
            const ElementRest& B = elements.inverse_rest[b];
            const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[b])];
            const LaneMat3<Real8> F = deformation_gradient(edges(elements.node[b], position), B);
            LaneMat3<Real8> P = with_law(material.model, [&](auto law) {
                if constexpr (law.has_frame) {
                    LaneQuaternion<Real8> q = load(rotation[b]);
                    extract_rotation(F, load(elements.volume[b]), q);
                    store(q, next.rotation[b]);
                    return law.stress(material, F, rotation_of(q));
                } else {
                    return law.stress(material, F);
                }
            });
            if (!elements.viscous_time.empty() && elements.viscous_time[b] > 0)
                P = P + viscous_stress(material, elements.viscous_time[b], F,
                                       deformation_gradient(edges(elements.node[b], velocity), B));
            if (material.relaxes() && !next.viscous_strain.empty())
                P = P + relax(viscous_moduli(material, elements.relaxing_share[b]), F, load(elements.volume[b]),
                              load(elements.relaxation_rate[b]), load(elements.own_frequency[b]), duration * h,
                              elements.viscous_strain[b], next.viscous_strain[b], next.relaxed[b]);
            spread_forces(P, B, duration * load(elements.volume[b]), force[b]);
        }
    });
    const auto relaxes = [](const MaterialConstants& material) { return material.relaxes(); };
    if (std::ranges::none_of(elements.constants, relaxes)) return 0;
    return std::accumulate(next.relaxed.begin(), next.relaxed.end(), Real{0});  // in order
}

}  // namespace skerry
