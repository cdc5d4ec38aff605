// Masses that elements take from their nodes for the bound on the step, where they are forms that couple the nodes of
// an element (docs/methods/stable_step.md 2.3).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Largest number of multiplications for the decomposition of a group's matrix: 0.1 s, or some 15,000 tetrahedra of a
/// block.
inline constexpr Real products_of_group = 4e8;

/// Diagonal of Q of an element that a cluster carries, which takes no mass and bounds nothing [1/(kg m^2)].
inline constexpr Real form_of_implicit = 1e-100;

/// Finds Q of the explicit elements of a body such that the masses G Q^-1 G^T, G the gradients of an element as
/// columns, add up to no more than those of the nodes: sum_e G Q^-1 G^T <= diag(mass). A Cholesky decomposition
/// verifies this, for the whole body, or for groups of its elements if that would cost more than `most_products`. With
/// A = V H (Q x 1) then K <= max_e lambda_max(A) M, as for any other way to share the mass. The Q are chosen so that
/// this is sharp for the shape at rest; they depend on no shape and hold for every one. `position`: of some shape that
/// is not degenerate, by which nodes are sorted [m]. `form`: of the blocks [1/(kg m^2)]; 0 where none was found.
/// Sequential, some 10 us a tetrahedron.
void find_mass_forms(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<const Real> mass, Real most_products, std::span<ElementForm> form);

}  // namespace skerry
