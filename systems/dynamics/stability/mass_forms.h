// The masses of the nodes are divided among the elements for a bound on the stable step. The part that an element gets
// is a matrix over its nodes, called its mass form. This file finds the forms (docs/methods/stable_step.md 2.3).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Upper limit on the number of multiplications in the decomposition of the matrix of a group of elements. So many
/// multiplications take about 0.1 s, enough for some 15,000 tetrahedra of a block-shaped body.
inline constexpr Real products_of_group = 4e8;

/// Diagonal entries of the matrix Q of an implicit element, which belongs to a cluster and takes no part in the
/// division of the masses [1/(kg m^2)]. With so small a Q, its bound limits no step. Zero would mean that a block has
/// no mass forms.
inline constexpr Real form_of_implicit = 1e-100;

/// Finds the matrices Q of the explicit elements of a body (docs/methods/stable_step.md 2.3). An element gets the mass
/// form G Q^-1 G^T from its nodes. Row k of G is the gradient of the shape function of node k. Sequential, about 10 us
/// per tetrahedron.
///
/// A Cholesky decomposition verifies that the sum of these forms is at most diag(mass), the matrix of the nodal masses.
/// The bound on the stable step that follows is valid for every shape, and sharp for the rest shape.
/// - `position`: any shape that is not degenerate, for sorting the nodes [m].
/// - `most_products`: if one decomposition for the complete body would cost more multiplications, groups of elements
///   are verified instead.
/// - `form`: Q by block; 0 if nothing was found [1/(kg m^2)].
void find_mass_forms(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<const Real> mass, Real most_products, std::span<ElementForm> form);

}  // namespace skerry
