// Finds mass shares of elements for a bound on the stable step. The bound is sharp while all elements of the body have
// about the same rotation (docs/methods/stable_step.md 2.4).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Upper limit on the number of multiplications in the decomposition of the matrix of a body. So many multiplications
/// take about 0.1 s, enough for some 4,000 tetrahedra of a block-shaped body.
inline constexpr Real products_of_frame = 4e8;

/// Finds the frame masses of the explicit elements of a body (docs/methods/stable_step.md 2.4). The mass of an element
/// is a quadratic form in the displacement gradient X: |X|^2 / q + b (R:X)^2. Here q and b are the entries of
/// `frame_mass`, and R is one rotation for the complete body. Sequential, about 10 us per tetrahedron.
///
/// A Cholesky decomposition verifies that the elements together get no more mass than the nodes have. The bound on the
/// stable step that follows is valid for every shape and every R. It is nearly sharp for the rest shape in any
/// rotation, and less sharp the more elements are rotated against each other.
/// - `position`: any shape that is not degenerate [m].
/// - `bound`: upper bound on the squared highest circular frequency of the body at rest, by block [1/s^2].
/// - `most_products`: bounds and masses are 0 if the decomposition would cost more multiplications.
void find_frame_masses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, Real most_products, std::span<FrameMass> frame_mass,
                       std::span<Real> bound);

}  // namespace skerry
