// Finds mass shares of elements for the step bound of a body that rotates as a whole (docs/methods/stable_step.md 2.4).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Limit on the number of multiplications for the decomposition of the matrix of a body. So many multiplications take
/// about 0.1 s, enough for some 4,000 tetrahedra of a block-shaped body.
inline constexpr Real products_of_frame = 4e8;

/// Finds the frame masses of the explicit elements of a body (docs/methods/stable_step.md 2.4): the masses that
/// elements get from the nodes, in proportion to a stiffness at rest that also resists rotations. Sequential, about 10
/// us per tetrahedron.
///
/// For displacements u with the gradient X = sum_k u_k (x) g_k an element gets the mass |X|^2 / q + b (R:X)^2. Here q
/// and b are the entries of `frame_mass`, and R is one rotation for the complete body. A Cholesky decomposition
/// verifies that the nodes have enough mass.
///
/// The resulting bound is valid for every shape and every R. It is nearly sharp for the rest shape in any rotation, and
/// less sharp the more elements are rotated against each other.
///
/// `position`: any shape that is not degenerate [m]. `bound`: upper bound on omega_max^2 at rest, by block [1/s^2].
/// Bounds and masses are 0 if the decomposition would cost more than `most_products` multiplications.
void find_frame_masses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, Real most_products, std::span<FrameMass> frame_mass,
                       std::span<Real> bound);

}  // namespace skerry
