// Shares the mass of each node among its elements in proportion to their stiffness, and bounds the frequency of each
// element with its share (docs/methods/stable_step.md 2). omega is the highest circular frequency of an element. A
// block is a group of eight elements, one in each lane of a vector.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/material/extract_rotation.h"

namespace skerry {

/// Product of the stable step and the bound on the highest frequency. It is a tenth below 2, the limit of symplectic
/// Euler.
inline constexpr Real step_times_frequency = 0.9 * 2;

/// Deformation gradients F of the elements of a block.
LaneMat3<Real8> deformation_of(const ElementInputs& elements, std::size_t block, std::span<const Vec3> position);

/// Weight of each element when its nodes share their masses (docs/methods/stable_step.md 2). At node k the element
/// counts with |g_k|^2 times the weight, where g_k is the gradient of the shape function of the node. The weight is
/// mass_share times the volume. If the stiffness of the material law varies with deformation, it is also multiplied by
/// an upper bound of dP/dF in the present shape.
Real8 stiffness_weight(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F);

/// Sets the initial mass_share of each element, a factor of stiffness_weight(). It is 1, except in these cases:
/// - Inversion barriers (guards): 0, because they act only as implicit elements of a cluster.
/// - Bodies of several materials: the stiffness of the element's material, unless stiffness_weight() already contains
///   it. It is in Pa if stiffness_weight() contains the stiffness of any other material of the body. Otherwise only
///   ratios matter, and it is divided by the greatest stiffness of the body.
void start_mass_shares(const ElementInputs& elements, Range blocks, std::span<ElementLane> mass_share);

/// Adds the stiffness of each element of a block to stiffness_sum at the nodes of the element, except in lanes for
/// which counts(lane) is false.
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

/// Sets stiffness_sum to 0 at the nodes of a block.
inline void clear_stiffness(const ElementInputs& elements, std::size_t block, std::span<Real> stiffness_sum) {
    const BlockNodes nodes = elements.nodes_of(block);
    for (Index k = 0; k < nodes.count; ++k)
        for (const Index node : nodes.node[k].lane) stiffness_sum[static_cast<std::size_t>(node)] = 0;
}

/// Upper bound of omega^2 of each element of a block [1/s^2]; NaN if F is not finite.
/// - With `stiffness_sum` the element gets the mass m_k = mass k_k / stiffness_sum from node k, where k_k is the
///   stiffness of the element at the node.
/// - Without it every element has the full mass of its nodes. The result is then no bound for a body, but the frequency
///   of the element alone.
/// - `q` is the initial guess of the corotational frame and receives the frame found.
/// - `threshold` [1/s^2]: see frequency_squared_bound().
Real8 frequency_squared_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                           std::span<const Real> mass, std::span<const Real> stiffness_sum, LaneQuaternion<Real8>& q,
                           Real threshold = 0);

/// True if the elements of a block have mass forms (mass_forms.h).
inline bool has_mass_form(const ElementInputs& elements, std::size_t block) {
    return !elements.mass_form.empty() && elements.mass_form[block][0][0] > 0;  // every block has an element in lane 0
}

/// Upper bound of omega^2 of each element of a block with the masses of mass_forms.h, at most 0.3 % too large [1/s^2].
Real8 frequency_squared_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                LaneQuaternion<Real8>& q, Real threshold = 0);

/// Upper bound of omega^2 of each element of a block with the masses of mass_forms.h [1/s^2]: the smallest of the
/// numbers `threshold`, 1.1 `threshold`, 1.21 `threshold`... that exceeds omega^2. It is infinite if omega^2 exceeds
/// about ten times `threshold`.
///
/// The springs of viscoelastic materials (Maxwell elements) count as in a step of length `step` [s]. In longer steps
/// they relax more and count less, so the bound is valid for this step and for longer ones.
Real8 stepped_by_form(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                      LaneQuaternion<Real8>& q, Real threshold, Real step);

/// Upper bound of omega^2 at rest for a body with frame masses (frame_masses.h); 0 for other bodies [1/s^2].
inline Real frame_bound(const ElementInputs& elements, Range blocks) {
    return elements.frame_bound.empty() || blocks.size() == 0
               ? 0
               : elements.frame_bound[static_cast<std::size_t>(blocks.begin)];
}

/// Upper bound of omega^2 of each element of a block with the masses of frame_masses.h, at most 0.3 % too large
/// [1/s^2]. `rotation`: mean rotation of the body.
Real8 frequency_squared_in_frame(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                                 const Mat3& rotation, LaneQuaternion<Real8>& q, Real threshold = 0);

/// Upper bound h on the Hessian dP/dF of each element of a block, with all viscous parts [Pa]. Let V be the volume of
/// the element, and g_k the gradient of the shape function of its node k. The matrix of the entries h V g_k.g_l for the
/// nodes k and l then bounds the stiffness of the element.
Real8 stiffness_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                   LaneQuaternion<Real8>& q);

/// True if every element of a block is less stiff than `times` the modulus that is assumed for it. `modulus`: the
/// assumed modulus; 0 if the element is not tested [Pa]. This test of dP/dF is exact, while the bound stiffness_of() is
/// up to 15 % too large. The test takes a tenth of the time.
bool less_stiff_than(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F, const Real8& modulus,
                     Real times, LaneQuaternion<Real8>& q);

}  // namespace skerry
