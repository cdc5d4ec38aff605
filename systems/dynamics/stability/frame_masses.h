// Finds mass shares of elements for the step bound of a body that rotates as a whole (docs/methods/stable_step.md 2.4).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Limit on the number of multiplications for the decomposition of the matrix of a body. So many multiplications take
/// about 0.1 s, enough for some 4,000 tetrahedra of a block-shaped body.
inline constexpr Real products_of_frame = 4e8;

/// Finds the masses that the explicit elements of a body get from its nodes. The masses are proportional to a stiffness
/// at rest in which rotations count like strains. For displacements u with the gradient X = sum_k u_k (x) g_k an
/// element gets the mass |X|^2 / q + b (R:X)^2. Here q and b are the entries of `frame_mass`, and R is one rotation for
/// the complete body. The resulting bound is nearly sharp for a rest shape in any rotation. It is valid for every other
/// shape and every R, and is sharper if elements are rotated less against each other. A Cholesky decomposition verifies
/// that the nodes have enough mass. Nothing is found if the decomposition would cost more than `most_products`
/// multiplications. `position`: any shape that is not degenerate [m]. `bound`: upper bound on omega_max^2 at rest by
/// block; 0 if nothing was found [1/s^2]. The masses are also 0 then. Sequential, about 10 us per tetrahedron.
void find_frame_masses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, Real most_products, std::span<FrameMass> frame_mass,
                       std::span<Real> bound);

}  // namespace skerry
