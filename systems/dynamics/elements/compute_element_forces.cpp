#include "systems/dynamics/elements/compute_element_forces.h"

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/material/extract_rotation.h"
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

}  // namespace

void compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, std::span<const ElementRotation> rotation,
                            std::span<ElementRotation> rotation_next, std::span<ElementForces> force) {
    SKERRY_CHECK(force.size() == elements.node.size() && rotation.size() == force.size() &&
                 rotation_next.size() == force.size());
    parallel_for(executor, elements.node.size(), blocks_per_job, [&](std::size_t begin, std::size_t end) {
        if (elements.schedule.none_active(begin, end)) return;
        for (std::size_t b = begin; b < end; ++b) {
            const Real duration = elements.schedule.duration(b);
            if (duration == 0) continue;
            const ElementRest& B = elements.inverse_rest[b];
            const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[b])];
            const LaneMat3<Real8> F = deformation_gradient(edges(elements.node[b], position), B);
            LaneMat3<Real8> P = with_law(material.model, [&](auto law) {
                if constexpr (law.has_frame) {
                    LaneQuaternion<Real8> q = load(rotation[b]);
                    extract_rotation(F, load(elements.volume[b]), q);
                    store(q, rotation_next[b]);
                    return law.stress(material, F, rotation_of(q));
                } else {
                    return law.stress(material, F);
                }
            });
            if (!elements.viscous_time.empty() && elements.viscous_time[b] > 0)
                P = P + viscous_stress(material, elements.viscous_time[b], F,
                                       deformation_gradient(edges(elements.node[b], velocity), B));
            spread_forces(P, B, duration * load(elements.volume[b]), force[b]);
        }
    });
}

}  // namespace skerry
