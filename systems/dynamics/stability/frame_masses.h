// Masses that elements take from their nodes for the bound on the step of a body that rotates as a whole
// (docs/methods/stable_step.md 2.4).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Largest number of multiplications for the decomposition of a body's matrix: 0.1 s, or some 4,000 tetrahedra of a
/// block.
inline constexpr Real products_of_frame = 4e8;

/// Finds the masses that the explicit elements of a body take from its nodes. They are proportional to the stiffness at
/// rest with rotations counted like strains. For displacements u with the gradient X = sum_k u_k (x) g_k an element
/// takes |X|^2 / q + b (R:X)^2, q and b of `frame_mass`, with one rotation R of the whole body. The bound is nearly
/// sharp for a shape at rest in any rotation. It holds for every other shape and every R, the better the less elements
/// are rotated against each other. A Cholesky decomposition verifies that nodes have so much mass; nothing is found if
/// it would cost more than `most_products`. `position`: of some shape that is not degenerate [m]. `bound`: by block,
/// upper bound on omega_max^2 at rest [1/s^2]; 0, and masses of 0, where nothing was found. Sequential, some 10 us a
/// tetrahedron.
void find_frame_masses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, Real most_products, std::span<FrameMass> frame_mass,
                       std::span<Real> bound);

}  // namespace skerry
