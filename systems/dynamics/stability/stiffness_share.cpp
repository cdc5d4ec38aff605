#include "systems/dynamics/stability/stiffness_share.h"

#include "systems/dynamics/stability/element_stiffness.h"
#include "systems/material/relaxation.h"
#include "systems/material/with_law.h"

namespace skerry {

namespace {

/// Rest gradients of the four corners: the rows of B, and minus their sum for corner 0.
struct Gradients {
    LaneVec3<Real8> g[4];
};

Gradients gradients_of(const ElementRest& B) {
    const LaneVec3<Real8> g1{load(B[0]), load(B[3]), load(B[6])}, g2{load(B[1]), load(B[4]), load(B[7])},
        g3{load(B[2]), load(B[5]), load(B[8])};
    return {{-1.0 * (g1 + g2 + g3), g1, g2, g3}};
}

/// Sum over the corners of g_a g_a^T / m_a.
LaneMat3<Real8> inverse_mass_tensor(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                    std::span<const Real> mass, std::span<const Real> stiffness_sum) {
    const Gradients at = gradients_of(elements.inverse_rest[block]);
    const std::array<Real8, 4> stiffness = corner_stiffness(elements, block, F);
    LaneMat3<Real8> Q{};
    for (std::size_t a = 0; a < 4; ++a) {
        Real8 inverse{};
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const std::size_t n = static_cast<std::size_t>(elements.node[block][a][l]);
            // No mass: a node that never moves.
            if (!(mass[n] > 0 && elements.volume[block][l] > 0)) continue;
            inverse[l] = stiffness_sum.empty() ? 1 / mass[n] : stiffness_sum[n] / (mass[n] * stiffness[a][l]);
        }
        const LaneVec3<Real8> scaled = inverse * at.g[a];
        Q = Q + LaneMat3<Real8>{at.g[a].x * scaled, at.g[a].y * scaled, at.g[a].z * scaled};
    }
    return Q;
}

}  // namespace

LaneMat3<Real8> deformation_of(const ElementInputs& elements, std::size_t block, std::span<const Vec3> position) {
    return deformation_gradient(edges(elements.node[block], position), elements.inverse_rest[block]);
}

std::array<Real8, 4> corner_stiffness(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F) {
    const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[block])];
    Real8 weight = load(elements.volume[block]);
    with_law(material.model, [&](auto law) {
        if constexpr (law.stiffness_varies) weight = weight * law.stiffness_bound(material, F);
    });
    const Gradients at = gradients_of(elements.inverse_rest[block]);
    return {weight * dot(at.g[0], at.g[0]), weight * dot(at.g[1], at.g[1]), weight * dot(at.g[2], at.g[2]),
            weight * dot(at.g[3], at.g[3])};
}

Real8 frequency_squared_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                           std::span<const Real> mass, std::span<const Real> stiffness_sum, LaneQuaternion<Real8>& q) {
    const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[block])];
    const LaneMat3<Real8> Q = inverse_mass_tensor(elements, block, F, mass, stiffness_sum);
    const Real8 volume = load(elements.volume[block]);
    // nothing, or no number where F is none: not every bound looks at F
    const Real8 nothing = 0.0 * inner_product(F, F);
    if (!material.relaxes() || elements.viscous_strain.empty())
        return frequency_squared_bound(material, F, {}, volume, Q, q) + nothing;
    ViscousPart viscous{viscous_moduli(material, elements.relaxing_share[block]),
                        viscous_stretch(green_strain(F), elements.viscous_strain[block])};
    const Real8 in_full = frequency_squared_bound(material, F, viscous, volume, Q, q);
    // A spring that relaxes by a step's end counts less, and the less the longer the step: the step by the springs in
    // full is a safe guess of it.
    const Real8 step = step_times_frequency / square_root(in_full > 0.0 ? in_full : Real8{} + 1.0);
    viscous.strain_share = 2.0 / (2.0 + step * load(elements.relaxation_rate[block]));
    viscous.volume_share = 2.0 / (2.0 + step * (load(elements.own_frequency[block]) / bulk_time));
    return frequency_squared_bound(material, F, viscous, volume, Q, q) + nothing;
}

}  // namespace skerry
