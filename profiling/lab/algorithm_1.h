// Literal implementation of Algorithm 1 of the paper, for comparison: the algorithm is incorrect
// (docs/methods/regions.md 2).
#pragma once

#include <span>

#include "components/contact_table.h"

namespace skerry::lab {

/// Scans the contacts like the paper. For i = 1..n, contact i opens a new area unless it has one. Every later contact
/// without an area then joins the area of i if it shares a mass point with any contact of that area so far. Two areas
/// that already have numbers are never merged, and an area is scanned only on behalf of its own contacts. Example:
/// contacts {1,2}, {5,6}, {2,5} give the areas {1,2,5} and {5,6}, which share point 5. Takes O(K^2) time. Writes the
/// areas, numbered from 0 by their first contact, and returns their number.
Index label_by_algorithm_1(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                           std::span<Index> contact_region);

/// Number of pairs of different regions that share a moving node: 0 for a correct separation. `contact_region` holds
/// the region of each contact.
Index count_shared_nodes(std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                         std::span<const Index> contact_region);

}  // namespace skerry::lab
