#include "systems/dynamics/stability/stiffness_share.h"

#include <algorithm>

#include "systems/dynamics/stability/element_stiffness.h"
#include "systems/material/relaxation.h"
#include "systems/material/with_law.h"

namespace skerry {

namespace {

/// Tensor Q of inverse masses of each element of a block. The bound on the frequency of an element is computed from it
/// (element_stiffness.cpp). Let g_k be the gradient of the shape function of node k, and m_k the mass that the element
/// gets from this node. Q is the sum of g_k g_k^T / m_k over the nodes k of the element.
LaneMat3<Real8> inverse_mass_tensor(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                    std::span<const Real> mass, std::span<const Real> stiffness_sum) {
    const BlockNodes nodes = elements.nodes_of(block);
    const Real8 weight = stiffness_weight(elements, block, F);
    LaneMat3<Real8> Q{};
    for (Index k = 0; k < nodes.count; ++k) {
        const LaneVec3<Real8> g = load_gradient(nodes.gradient[k]);
        const Real8 stiffness = weight * dot(g, g);
        Real8 inverse{};
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const std::size_t n = static_cast<std::size_t>(nodes.node[k][l]);
            // A node without mass never moves. A node without stiffness is padding, or the element exerts no force on
            // it. A stiffness that is NaN is kept: the bound of the element must become NaN.
            if (!(mass[n] > 0 && elements.volume[block][l] > 0)) continue;
            if (stiffness_sum.empty())
                inverse[l] = 1 / mass[n];
            else if (stiffness[l] > 0 || stiffness[l] != stiffness[l])
                inverse[l] = stiffness_sum[n] / (mass[n] * stiffness[l]);
        }
        const LaneVec3<Real8> scaled = inverse * g;
        Q = Q + LaneMat3<Real8>{g.x * scaled, g.y * scaled, g.z * scaled};
    }
    return Q;
}

ViscousPart viscous_part(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F) {
    return {viscous_moduli(elements.material_of(block), elements.relaxing_share[block]),
            springs_in(twice_green_strain(F), elements.spring_strain[block]).sum()};
}

/// Sets the fractions to which the springs of viscoelastic materials (Maxwell elements) count in steps of length `step`
/// [s]. In longer steps a spring counts less, because it relaxes more.
void count_springs(const ElementInputs& elements, std::size_t block, const Real8& step, ViscousPart& viscous) {
    viscous.strain_share = springs_that_count(elements.relaxation_rate[block], step);
    viscous.volume_share = 2.0 / (2.0 + step * (load(elements.own_frequency[block]) / bulk_time));
}

/// Upper bound of omega^2 of each element of a block with the inverse masses Q [1/s^2].
Real8 bound_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F, const LaneMat3<Real8>& Q,
               LaneQuaternion<Real8>& q, Real threshold, Sharpness sharpness, const FramePart* frame = nullptr) {
    const MaterialConstants material = elements.material_of(block);
    const Real8 volume = load(elements.volume[block]);
    // 0, or NaN if F is not finite. It is added to each bound, so that even a bound that does not depend on F becomes
    // NaN.
    const Real8 nothing = 0.0 * inner_product(F, F);
    if (!material.relaxes() || elements.spring_strain.empty())
        return frequency_squared_bound(material, F, {}, volume, Q, q, threshold, sharpness, frame) + nothing;
    ViscousPart viscous = viscous_part(elements, block, F);
    const auto count_in = [&](const Real8& step) { count_springs(elements, block, step, viscous); };
    // Quick test: most elements are stable at the step to which `threshold` belongs, and need no exact bound. The
    // springs relax as in that step. With unrelaxed springs nearly all elements would fail the test, since all elements
    // at rest allow about the same step.
    if (threshold > 0) {
        count_in(Real8{} + step_times_frequency / std::sqrt(threshold));
        const Real8 compared =
            frequency_squared_bound(material, F, viscous, volume, Q, q, threshold, Sharpness::compared, frame);
        if (all(compared <= threshold)) return compared + nothing;
        viscous.strain_share = Real8{} + Real{maxwell_count};
        viscous.volume_share = Real8{} + 1.0;
    }
    // The stable step with unrelaxed springs is shorter than the stable step with relaxing springs. It is therefore a
    // safe estimate of the step in which springs relax.
    const Real8 in_full = frequency_squared_bound(material, F, viscous, volume, Q, q, threshold, sharpness, frame);
    count_in(step_times_frequency / square_root(in_full > 0.0 ? in_full : Real8{} + 1.0));
    return frequency_squared_bound(material, F, viscous, volume, Q, q, threshold, sharpness, frame) + nothing;
}

}  // namespace

LaneMat3<Real8> deformation_of(const ElementInputs& elements, std::size_t block, std::span<const Vec3> position) {
    return deformation_gradient(elements.nodes_of(block), position);
}

Real8 stiffness_weight(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F) {
    const MaterialConstants material = elements.material_of(block);
    Real8 weight = load(elements.mass_share[block]) * load(elements.volume[block]);
    with_law(material.model, [&](auto law) {
        if constexpr (law.stiffness_varies) weight = weight * law.stiffness_bound(material, F);
    });
    return weight;
}

void start_mass_shares(const ElementInputs& elements, Range blocks, std::span<ElementLane> mass_share) {
    const auto constants_of = [&](std::size_t b) -> const MaterialConstants& {
        return elements.constants[static_cast<std::size_t>(elements.material[b])];
    };
    const auto stiffness = [](const MaterialConstants& m) { return m.lame_lambda + 2 * m.shear_modulus; };
    const auto varies = [](const MaterialConstants& m) {
        return with_law(m.model, [](auto law) { return law.stiffness_varies; });
    };
    const auto first = static_cast<std::size_t>(blocks.begin), end = static_cast<std::size_t>(blocks.end);
    bool any_varies = false, several = false;
    Real stiffest = 0;
    for (std::size_t b = first; b < end; ++b) {
        any_varies |= varies(constants_of(b));
        several |= elements.material[b] != elements.material[first];
        stiffest = std::max(stiffest, stiffness(constants_of(b)));
    }
    for (std::size_t b = first; b < end; ++b) {
        const bool known = !several || varies(constants_of(b));
        const Real share = known ? 1 : stiffness(constants_of(b)) / (any_varies ? 1 : stiffest);
        for (Real& lane : mass_share[b - first].lane) lane = elements.part[b] == ElementPart::guard ? 0 : share;
    }
}

Real8 frequency_squared_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                           std::span<const Real> mass, std::span<const Real> stiffness_sum, LaneQuaternion<Real8>& q,
                           Real threshold) {
    return bound_of(elements, block, F, inverse_mass_tensor(elements, block, F, mass, stiffness_sum), q, threshold,
                    Sharpness::trace);
}

namespace {

LaneMat3<Real8> form_of(const ElementInputs& elements, std::size_t block) {
    const ElementForm& form = elements.mass_form[block];
    const Real8 xy = load(form[3]), yz = load(form[4]), zx = load(form[5]);
    return {{load(form[0]), xy, zx}, {xy, load(form[1]), yz}, {zx, yz, load(form[2])}};
}

}  // namespace

Real8 frequency_squared_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                LaneQuaternion<Real8>& q, Real threshold) {
    return bound_of(elements, block, F, form_of(elements, block), q, threshold, Sharpness::bisected);
}

Real8 stepped_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                      LaneQuaternion<Real8>& q, Real threshold, Real step) {
    const MaterialConstants material = elements.material_of(block);
    ViscousPart viscous;
    if (material.relaxes() && !elements.spring_strain.empty()) {
        viscous = viscous_part(elements, block, F);
        count_springs(elements, block, Real8{} + step, viscous);
    }
    return frequency_squared_bound(material, F, viscous, load(elements.volume[block]), form_of(elements, block), q,
                                   threshold, Sharpness::stepped) +
           0.0 * inner_product(F, F);  // this term makes the bound NaN if F is not finite
}

Real8 frequency_squared_in_frame(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                 const Mat3& rotation, LaneQuaternion<Real8>& q, Real threshold) {
    const FrameMass& mass = elements.frame_mass[block];
    const Real8 strain_mass = load(mass[0]), zero{};
    const FramePart frame{rotation, load(mass[1])};
    return bound_of(elements, block, F,
                    {{strain_mass, zero, zero}, {zero, strain_mass, zero}, {zero, zero, strain_mass}}, q, threshold,
                    Sharpness::bisected, &frame);
}

namespace {

/// Upper bound on `volume` times the largest eigenvalue of dP/dF in each lane. It is the result of
/// frequency_squared_bound() with unit masses, and with `volume` in place of the volumes of the elements.
Real8 hessian_bound(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F, const Real8& volume,
                    LaneQuaternion<Real8>& q, Real threshold, Sharpness sharpness) {
    const MaterialConstants material = elements.material_of(block);
    const bool viscous = material.relaxes() && !elements.spring_strain.empty();
    const Real8 one = Real8{} + 1.0, zero{};
    return frequency_squared_bound(material, F, viscous ? viscous_part(elements, block, F) : ViscousPart{}, volume,
                                   {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}, q, threshold, sharpness);
}

}  // namespace

Real8 stiffness_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                   LaneQuaternion<Real8>& q) {
    return hessian_bound(elements, block, F, Real8{} + 1.0, q, 0, Sharpness::trace);
}

bool less_stiff_than(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F, const Real8& modulus,
                     Real times, LaneQuaternion<Real8>& q) {
    const Real8 over_modulus = modulus > 0.0 ? 1.0 / modulus : Real8{};
    return all(hessian_bound(elements, block, F, over_modulus, q, times, Sharpness::compared) <= times);
}

}  // namespace skerry
