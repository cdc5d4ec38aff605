// The masses that elements take from their nodes for the bound on the step, where they are not those of single nodes
// (docs/methods/stable_step.md 2.3).
#pragma once

#include <span>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Products of numbers that the decomposition of a group's matrix may cost, 0.1 s: some 15,000 tetrahedra of a block.
inline constexpr Real products_of_group = 4e8;

/// 1/(kg m^2), diagonal of Q of an element that a cluster carries: it takes no mass, and bounds nothing.
inline constexpr Real form_of_implicit = 1e-100;

/// Finds Q of the explicit elements of a body, so that the masses G Q^-1 G^T, G the gradients of an element as columns,
/// come to no more than those of the nodes together: sum_e G Q^-1 G^T <= diag(mass). A Cholesky decomposition makes
/// sure of it, of the whole body, or of groups of its elements where that would cost more than `most_products`. Then,
/// with A = V H (Q x 1), K <= max_e lambda_max(A) M as for any other way to share the mass, and the Q are chosen so
/// that this is sharp for the shape at rest. They depend on no shape and hold for every one. `position`: m, of some
/// shape that is not degenerate: nodes are put in a row by it. `form`: 1/(kg m^2), of the blocks; 0 where none was
/// found. Sequential, some 10 us a tetrahedron.
void find_mass_forms(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<const Real> mass, Real most_products, std::span<ElementForm> form);

}  // namespace skerry
