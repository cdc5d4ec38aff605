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

/// What the fields of some nodes of a body are made of: the tetrahedra around them, and the elements that cover those.
struct ElementsAround {
    std::vector<Index> block;                   // of the body, from 0, ascending
    std::vector<ElementPart> part;              // of each
    Ragged<Index> covered;                      // by the element at each place of them: places in `tetrahedron`
    std::vector<Index> tetrahedron;             // numbered within the body, ascending
    std::vector<std::array<Index, 4>> corners;  // of each: places in the list of nodes; its length: another node
};

/// `tetrahedra`: all of the body. `nodes`: no two alike.
ElementsAround elements_around(const ElementCover& cover, std::span<const std::array<Index, 4>> tetrahedra,
                               std::span<const Index> nodes, std::size_t node_count);

/// By tetrahedron: the mean of the elements that cover it, of each part of the stress by itself, and their sum.
std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// By tetrahedron: the mean of the elements that cover it, but for those that carry the volumetric part only.
std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// By node: the mean of the tetrahedra around it, weighted with their volume (m^3, at rest).
std::vector<Mat3> means_of_nodes(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> volume,
                                 std::span<const Mat3> of_tetrahedra, std::size_t node_count);

}  // namespace skerry
