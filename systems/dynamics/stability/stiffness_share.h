// Shares of the mass of each node for its elements, in proportion to their stiffness, and the frequency that bounds
// each element then (docs/methods/stable_step.md 2).
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/material/extract_rotation.h"

namespace skerry {

/// Product of a stable step and the frequency bound: a tenth below the limit of symplectic Euler, which is 2.
inline constexpr Real step_times_frequency = 0.9 * 2;

/// Deformation gradients F of a block of elements.
LaneMat3<Real8> deformation_of(const ElementInputs& elements, std::size_t block, std::span<const Vec3> position);

/// Weight of an element when the mass of its nodes is shared: its mass_share times V, times the bound of the material's
/// Hessian if deformation changes it much. Node k counts with |g_k|^2 times this weight.
Real8 stiffness_weight(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F);

/// Sets the initial mass_share. In a body with several materials an element whose law leaves its stiffness out of the
/// weight has it here: relative to the greatest of the body, or in Pa beside laws that have it in their weight.
/// Otherwise the share is 1. Inversion barriers (guards) take no mass: they act only where a cluster carries them.
void start_mass_shares(const ElementInputs& elements, Range blocks, std::span<ElementLane> mass_share);

/// stiffness_sum[node] += the stiffness of each element of the block at the node, for lanes with counts(lane).
template <class Counts>
void add_stiffness(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                   std::span<Real> stiffness_sum, Counts&& counts) {
    const BlockNodes nodes = elements.nodes_of(block);
    const Real8 weight = stiffness_weight(elements, block, F);
    for (Index k = 0; k < nodes.count; ++k) {
        const LaneVec3<Real8> g = load_gradient(nodes.gradient[k]);
        const Real8 stiffness = weight * dot(g, g);
        for (std::size_t l = 0; l < element_lanes; ++l)
            if (counts(l)) stiffness_sum[static_cast<std::size_t>(nodes.node[k][l])] += stiffness[l];
    }
}

/// stiffness_sum = 0 at the nodes of the block.
inline void clear_stiffness(const ElementInputs& elements, std::size_t block, std::span<Real> stiffness_sum) {
    const BlockNodes nodes = elements.nodes_of(block);
    for (Index k = 0; k < nodes.count; ++k)
        for (const Index node : nodes.node[k].lane) stiffness_sum[static_cast<std::size_t>(node)] = 0;
}

/// Bound of omega^2 of each element of a block [1/s^2], with masses m_k = mass k_k / stiffness_sum. Without
/// stiffness_sum every element has all the mass of its nodes: that is no bound for a body, but shows the frequency of
/// the element alone. Not a number if F is not finite. `q` is a start of the corotational frame and is left at the
/// frame found. `enough` [1/s^2]: as in frequency_squared_bound().
Real8 frequency_squared_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                           std::span<const Real> mass, std::span<const Real> stiffness_sum, LaneQuaternion<Real8>& q,
                           Real enough = 0);

/// True if the elements of a block have mass forms (mass_forms.h).
inline bool has_mass_form(const ElementInputs& elements, std::size_t block) {
    return !elements.mass_form.empty() && elements.mass_form[block][0][0] > 0;  // every block has an element in lane 0
}

/// Bound of omega^2 of each element of a block with the masses of mass_forms.h, at most 0.3 % too large [1/s^2].
Real8 frequency_squared_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                LaneQuaternion<Real8>& q, Real enough = 0);

/// Bound of omega^2 with the masses of mass_forms.h: the least of `enough`, 1.1 `enough`, 1.21 `enough`... that an
/// element is below; infinity beyond ten times `enough` [1/s^2]. Springs relax as they do in steps of `step` [s], so
/// that they count less in every longer step.
Real8 stepped_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                      LaneQuaternion<Real8>& q, Real enough, Real step);

/// Bound of omega^2 at rest of a body with frame masses (frame_masses.h); 0 for other bodies [1/s^2].
inline Real frame_bound(const ElementInputs& elements, Range blocks) {
    return elements.frame_bound.empty() || blocks.size() == 0
               ? 0
               : elements.frame_bound[static_cast<std::size_t>(blocks.begin)];
}

/// Bound of omega^2 of each element of a block with the masses of frame_masses.h, the body rotated by `rotation`, at
/// most 0.3 % too large [1/s^2].
Real8 frequency_squared_in_frame(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                 const Mat3& rotation, LaneQuaternion<Real8>& q, Real enough = 0);

/// Bound of the material's Hessian of each element of a block, with all of its viscous parts [Pa]: K <= this V sum
/// g_k.g_l.
Real8 stiffness_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                   LaneQuaternion<Real8>& q);

/// True if every element of a block is less stiff than `times` its assumed stiffness (`modulus` [Pa]; 0: not tested).
/// The Hessian itself is tested, which stiffness_of() bounds within 15 %, in a tenth of the time.
bool less_stiff_than(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F, const Real8& modulus,
                     Real times, LaneQuaternion<Real8>& q);

}  // namespace skerry
