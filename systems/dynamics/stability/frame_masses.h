// Finds mass shares of elements for a bound on the stable step. The bound is sharp while all elements of the body have
// about the same rotation (docs/methods/stable_step.md 2.4).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Upper limit on the number of multiplications in the decomposition of the matrix of a body. So many multiplications
/// take about 0.1 s, enough for some 4,000 tetrahedra of a block-shaped body.
inline constexpr Real products_of_frame = 4e8;

/// Finds the frame masses of the explicit elements of a body (docs/methods/stable_step.md 2.4). An element gets a part
/// of the masses of its nodes in proportion to a stiffness at rest which, unlike that of the material law, also resists
/// rotations. Sequential, about 10 us per tetrahedron.
///
/// For node displacements u_k with the gradient X = sum_k u_k (x) g_k, the mass of an element is the quadratic form
/// |X|^2 / q + b (R:X)^2. Here q and b are the entries of `frame_mass`, and R is one rotation for the complete body. A
/// Cholesky decomposition verifies that the elements together get no more mass than the nodes have.
///
/// The bound on the stable step that follows from these masses is valid for every shape and every R. It is nearly sharp
/// for the rest shape in any rotation, and less sharp the more elements are rotated against each other.
///
/// `position`: any shape that is not degenerate [m]. `bound`: upper bound on omega_max^2 at rest, by block, with the
/// highest circular frequency omega_max of the body [1/s^2]. Bounds and masses are 0 if the decomposition would cost
/// more than `most_products` multiplications.
void find_frame_masses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, Real most_products, std::span<FrameMass> frame_mass,
                       std::span<Real> bound);

}  // namespace skerry
