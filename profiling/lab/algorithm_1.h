// Algorithm 1 of the paper to the letter, for comparison: it is incorrect (docs/methods/regions.md 2).
#pragma once

#include <span>

#include "components/contact_table.h"

namespace skerry::lab {

/// The paper's scan: for i = 1..n, a contact without an area opens a new one; then every later contact without an area
/// joins the area of i if it shares a mass point with any contact of that area so far. Areas that both have numbers
/// already are never merged, and an area is scanned only on behalf of its own contacts: contacts {1,2}, {5,6}, {2,5}
/// come out as areas {1,2,5} and {5,6}, which share point 5. O(K^2). Writes the areas, numbered from 0 by their first
/// contact; returns how many.
Index label_by_algorithm_1(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                           std::span<Index> contact_region);

/// How many pairs of different regions share a moving node: 0 for a correct separation. `contact_region`: the region of
/// each contact.
Index count_shared_nodes(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                         std::span<const Index> contact_region);

}  // namespace skerry::lab
