// An order of tetrahedral elements in which neighbours share what they fetch.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Which of an element's nodes, as the list has them, comes first, second, ...
using NodeOrder = std::array<std::uint8_t, 4>;

/// Sorts elements of four nodes into fans: tetrahedra around an edge, each of which has a face in common with the one
/// before. Nodes 0 and 1 are the edge, node 3 of an element is node 2 of the next. Eight fans of the same length lie
/// side by side in as many blocks as they have elements: element i of fan l is lane l of block i. What is left over
/// are fans of one. The longest fans come first; the order depends on nothing but the list.
/// `elements`: of the list, in any order. `order`: by element of the list.
void sort_into_fans(const ElementList& list, std::span<Index> elements, std::vector<NodeOrder>& order);

}  // namespace skerry
