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

/// Lists of the tetrahedra that each element of a body covers. An element covers the tetrahedra over which it averages
/// the deformation gradient. The list is empty for an unused lane and for a guard (inversion barrier). Tetrahedra are
/// numbered within the body.
struct ElementCover {
    std::span<const ElementPart> part;  // by block: part of the stress of its elements
    RaggedView<Index> tetrahedra;       // by lane: tetrahedra that its element covers
};

/// Stress of each of the `count` tetrahedra of a body [Pa]. Each part of the stress (`whole`, `shear` and `volume` of
/// ElementPart) is averaged over the elements that cover the tetrahedron. The stress is the sum of these means.
/// `element_values`: stress by lane of the blocks.
std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> element_values,
                                       std::size_t count);

/// Strain of each of the `count` tetrahedra of a body: the mean over the elements that cover it. Elements with only the
/// volumetric part of the stress do not count. `element_values`: strain by lane of the blocks.
std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> element_values,
                                       std::size_t count);

/// For each of the `count` tetrahedra of a body: mean of an element value over the elements that cover it. Elements
/// with only the volumetric part of the stress do not count. `block_values`: values by block and lane.
std::vector<Real> mean_of_tetrahedra(const ElementCover& cover, std::span<const ElementLane> block_values,
                                     std::size_t count);

}  // namespace skerry
