// The masses that elements take from their nodes for the bound on the step of a body that turns as a whole
// (docs/methods/stable_step.md 2.4).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Products of numbers that the decomposition of a body's matrix may cost, 0.1 s: some 4,000 tetrahedra of a block.
inline constexpr Real products_of_frame = 4e8;

/// Finds what the explicit elements of a body take of the mass of its nodes in proportion to what their stiffness at
/// rest would be without that against turns counting less: of displacements u with the gradient X = sum_k u_k (x) g_k
/// an element takes |X|^2 / q + b (R:X)^2, q and b of `mass`, with one rotation R of the whole body. That is nearly all
/// there is to know of a shape at rest, in any place, and holds for every other shape and every R, the better the less
/// elements are turned against each other. A Cholesky decomposition makes sure that nodes have so much mass; where that
/// would cost more than `most_products` nothing is found. `position`: m, of some shape that is not degenerate.
/// `bound`: by block, 1/s^2, omega_max^2 at rest from above; 0, and masses of 0, where nothing was found. Sequential,
/// some 10 us a tetrahedron.
void find_frame_masses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, Real most_products, std::span<FrameMass> frame_mass,
                       std::span<Real> bound);

}  // namespace skerry
