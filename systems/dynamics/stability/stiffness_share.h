// How the mass of each node is shared among its elements, in proportion to their stiffness, and the frequency that
// bounds each element then (docs/methods/stable_step.md 2).
#pragma once

#include <array>
#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/material/extract_rotation.h"

namespace skerry {

/// A step of this length times the frequency bound is 1.8: a tenth below what symplectic Euler stands.
inline constexpr Real step_times_frequency = 0.9 * 2;

/// F of a block of elements.
LaneMat3<Real8> deformation_of(const ElementInputs& elements, std::size_t block, std::span<const Vec3> position);

/// How stiff each corner is held: V |g_a|^2, times the bound of the material's Hessian where deformation changes it
/// much.
std::array<Real8, 4> corner_stiffness(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F);

/// Bound of omega^2 of each element of a block, 1/s^2, with masses m_a = mass k_a / stiffness_sum; without
/// stiffness_sum every element has all the mass of its nodes, which is no bound for a body but tells what the element
/// does alone. Not a number where F is none. `q` is a start of the corotational frame and is left at the frame found.
Real8 frequency_squared_of(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& F,
                           std::span<const Real> mass, std::span<const Real> stiffness_sum, LaneQuaternion<Real8>& q);

}  // namespace skerry
