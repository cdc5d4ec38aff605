// Computes stress and strain of tetrahedra and of nodes from the values of the elements (docs/methods/elasticity.md
// 7.5).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// Lists of the tetrahedra that each element of a body covers, lane by lane of the body's blocks, including unused
/// lanes. Tetrahedra are numbered within the body.
struct ElementCover {
    std::span<const ElementPart> part;  // of each block
    RaggedView<Index> tetrahedra;       // tetrahedra that the element of each lane covers
};

/// Tetrahedra around some nodes of a body, and the elements that cover these tetrahedra. Fields at the nodes are
/// computed from these elements.
struct ElementsAround {
    std::vector<Index> block;        // blocks of the elements, counted from the first block of the body, ascending
    std::vector<ElementPart> part;   // of each block
    Ragged<Index> covered;           // tetrahedra that the element of each lane covers: indices into `tetrahedron`
    std::vector<Index> tetrahedron;  // tetrahedra around the nodes, numbered within the body, ascending
    // For each tetrahedron: index of each corner in `nodes`, or nodes.size() if the corner is not listed.
    std::vector<std::array<Index, 4>> corners;
};

/// Finds the tetrahedra around `nodes`, which must be distinct, and the elements that cover these tetrahedra.
/// `tetrahedra`: all tetrahedra of the body.
ElementsAround elements_around(const ElementCover& cover, std::span<const std::array<Index, 4>> tetrahedra,
                               std::span<const Index> nodes, std::size_t node_count);

/// Stress of each tetrahedron [Pa]. For each part of the stress (ElementPart), the mean over the elements that cover
/// the tetrahedron is taken; these means are added up.
std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// Strain of each tetrahedron: the mean over the elements that cover it. Elements with only the volumetric part of the
/// stress do not count.
std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// Field at each node: the mean over the tetrahedra around the node. The weights are the rest volumes of the
/// tetrahedra, `volume` [m^3].
std::vector<Mat3> means_of_nodes(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> volume,
                                 std::span<const Mat3> of_tetrahedra, std::size_t node_count);

}  // namespace skerry
