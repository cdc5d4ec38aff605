// How the mass of each node is shared among its elements, in proportion to their stiffness, and the frequency that
// bounds each element then (docs/methods/stable_step.md 2).
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/material/extract_rotation.h"

namespace skerry {

/// A step of this length times the frequency bound is 1.8: a tenth below what symplectic Euler stands.
inline constexpr Real step_times_frequency = 0.9 * 2;

/// F of a block of elements.
LaneMat3<Real8> deformation_of(const ElementInputs& elements, std::size_t block, std::span<const Vec3> position);

/// What an element weighs when the mass of its nodes is shared: its mass_share times V, times the bound of the
/// material's Hessian where deformation changes it much. Node k counts with |g_k|^2 times this.
Real8 stiffness_weight(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F);

/// What mass_share starts with. Where a body has several materials, an element whose law leaves its stiffness out of
/// its weight has it here, over the greatest of the body, or in Pa beside laws that have it in their weight; else 1.
/// Guards take no mass: they act only where a cluster carries them.
void start_mass_shares(const ElementInputs& elements, Range blocks, std::span<ElementLane> mass_share);

/// stiffness_sum[node] += the stiffness with which each element of the block holds it; of lanes where `counts` says so.
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

/// Bound of omega^2 of each element of a block, 1/s^2, with masses m_k = mass k_k / stiffness_sum; without
/// stiffness_sum every element has all the mass of its nodes, which is no bound for a body but tells what the element
/// does alone. Not a number where F is none. `q` is a start of the corotational frame and is left at the frame found.
/// `enough`, 1/s^2: as frequency_squared_bound has it.
Real8 frequency_squared_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                           std::span<const Real> mass, std::span<const Real> stiffness_sum, LaneQuaternion<Real8>& q,
                           Real enough = 0);

/// Whether the elements of a block have mass forms (mass_forms.h).
inline bool has_mass_form(const ElementInputs& elements, std::size_t block) {
    return !elements.mass_form.empty() && elements.mass_form[block][0][0] > 0;  // a block has an element in lane 0
}

/// The same with the masses of mass_forms.h, at most 0.3 % too large.
Real8 frequency_squared_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                LaneQuaternion<Real8>& q, Real enough = 0);

/// The same, the least of `enough`, 1.1 `enough`, 1.21 `enough`... that an element is below; infinity beyond ten times
/// that. Springs relax as they do in steps of `step` (s), and so for every longer one less.
Real8 stepped_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                      LaneQuaternion<Real8>& q, Real enough, Real step);

/// 1/s^2, bound of omega^2 at rest of a body with frame masses (frame_masses.h); 0 of the others.
inline Real frame_bound(const ElementInputs& elements, Range blocks) {
    return elements.frame_bound.empty() || blocks.size() == 0
               ? 0
               : elements.frame_bound[static_cast<std::size_t>(blocks.begin)];
}

/// The same with the masses of frame_masses.h, the body turned by `rotation`, at most 0.3 % too large.
Real8 frequency_squared_in_frame(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                 const Mat3& rotation, LaneQuaternion<Real8>& q, Real enough = 0);

/// Pa, bound of the material's Hessian of each element of a block, what is viscous in full: K <= this V sum g_k.g_l.
Real8 stiffness_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                   LaneQuaternion<Real8>& q);

/// Whether every element of a block is less stiff than this times what it is taken to be (`modulus`, Pa; 0: not asked),
/// by the Hessian itself, which stiffness_of bounds within 15 %: in a tenth of the time.
bool less_stiff_than(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F, const Real8& modulus,
                     Real times, LaneQuaternion<Real8>& q);

}  // namespace skerry
