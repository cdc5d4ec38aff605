// Computes stress and strain of tetrahedra from the values of the elements (docs/methods/elasticity.md 7.5).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/element_table.h"
#include "components/material_table.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

/// Lists of the tetrahedra that each element of a body covers, lane by lane of the body's blocks, including unused
/// lanes. Tetrahedra are numbered within the body.
struct ElementCover {
    std::span<const ElementPart> part;  // by block: part of the stress of its elements
    RaggedView<Index> tetrahedra;       // tetrahedra that the element of each lane covers
};

/// Stress of each tetrahedron [Pa]. For each part of the stress (ElementPart), the mean over the elements that cover
/// the tetrahedron is taken; these means are added up.
std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// Strain of each tetrahedron: the mean over the elements that cover it. Elements with only the volumetric part of the
/// stress do not count.
std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count);

/// Mean of a value of the elements over those that cover a tetrahedron. Elements with only the volumetric part of the
/// stress do not count. `of_blocks`: values by block and lane.
std::vector<Real> mean_of_tetrahedra(const ElementCover& cover, std::span<const ElementLane> of_blocks,
                                     std::size_t count);

}  // namespace skerry
