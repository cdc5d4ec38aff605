// Stress and strain of tetrahedra and of nodes, from those of the elements (docs/methods/elasticity.md 7.5).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// The elements of a body, place by place (ElementInputs' blocks times lanes, left over lanes, too).
struct ElementCover {
    std::span<const ElementPart> part;  // of each block
    RaggedView<Index> tetrahedra;       // that the element at each place covers, numbered within the body
};

/// By tetrahedron: the mean of the elements that cover it, of each part of the stress by itself, and their sum.
std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// By tetrahedron: the mean of the elements that cover it, but for those that carry the volumetric part only.
std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// By node: the mean of the tetrahedra around it, weighted with their volume (m^3, at rest).
std::vector<Mat3> means_of_nodes(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> volume,
                                 std::span<const Mat3> of_tetrahedra, std::size_t node_count);

}  // namespace skerry
