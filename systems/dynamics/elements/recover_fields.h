// Stress and strain of tetrahedra and of nodes, from those of the elements (docs/methods/elasticity.md 7.5).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// The elements of a body by place: lane by lane of its blocks in ElementInputs, unused lanes included.
struct ElementCover {
    std::span<const ElementPart> part;  // of each block
    RaggedView<Index> tetrahedra;       // covered by the element at each place; numbered within the body
};

/// The tetrahedra around some nodes of a body and the elements that cover these: the sources of fields at the nodes.
struct ElementsAround {
    std::vector<Index> block;                   // blocks of these elements, counted within the body, ascending
    std::vector<ElementPart> part;              // of each block
    Ragged<Index> covered;                      // by the element at each place of the blocks: places in `tetrahedron`
    std::vector<Index> tetrahedron;             // numbered within the body, ascending
    std::vector<std::array<Index, 4>> corners;  // by tetrahedron: places in `nodes`, or its length
};

/// Finds the tetrahedra and elements around `nodes`, which must be distinct. `tetrahedra`: all of the body.
ElementsAround elements_around(const ElementCover& cover, std::span<const std::array<Index, 4>> tetrahedra,
                               std::span<const Index> nodes, std::size_t node_count);

/// Stress by tetrahedron: for each part of the stress the mean of the elements that cover it, summed over the parts.
std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// Strain by tetrahedron: the mean of the elements that cover it, except those that carry the volumetric part only.
std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// Field by node: the mean of the tetrahedra around it, weighted with their volume at rest [m^3].
std::vector<Mat3> means_of_nodes(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> volume,
                                 std::span<const Mat3> of_tetrahedra, std::size_t node_count);

}  // namespace skerry
