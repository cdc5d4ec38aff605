// Rows of the tables for the tetrahedra and elements of a new body.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/element_table.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Greatest number of elements of a patch. It is about 10 us of work, well above the cost of starting a job, and the
/// positions and forces of its nodes fit into the L1 cache.
inline constexpr std::size_t elements_per_patch = 256;

/// Smallest altitude of a tetrahedron [m].
Real smallest_altitude(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position);

/// Appends the blocks of a new body's tetrahedra, in the order of the mesh. `tetrahedra` index the body's own nodes;
/// `first_node` is the row of its first node.
Range append_tetrahedra(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                        Index first_node, TetrahedronBlockTable& table);

/// Places of the elements of a list in the blocks.
struct ElementPlaces {
    std::vector<Index> element;             // element of the list, block by block; no_index in an unused lane
    std::vector<std::uint8_t> opens_patch;  // by block
};

struct AppendedElements {
    Range blocks, nodes;         // rows
    std::vector<Index> element;  // element of the list, block by block; no_index in an unused lane
};

/// Finds places patch after patch. A patch is a spatially compact group of up to elements_per_patch elements, found by
/// repeated halving along the longest side. Within a patch each block has elements of one part and one material, and
/// elements with equal numbers of nodes are adjacent, so that few rows are unused. Otherwise elements keep their order.
/// `rest_position`: positions of the body's nodes at rest [m]. Guards have patches of their own, behind the others.
ElementPlaces find_places(const ElementList& list, std::span<const Vec3> rest_position);

/// Appends the elements of a new body at their places, which were found for a list with the same nodes.
AppendedElements append_elements(const ElementList& list, const ElementPlaces& places, Index first_node, Index body,
                                 ElementBlockTable& blocks, ElementNodeTable& nodes);
/// Finds the places of the elements of a new body and appends the elements there.
AppendedElements append_elements(const ElementList& list, std::span<const Vec3> rest_position, Index first_node,
                                 Index body, ElementBlockTable& blocks, ElementNodeTable& nodes);

/// Rotates the rest shape of elements: their gradients and their mass forms.
void turn_elements(const Mat3& rotation, Range rows, ElementBlockTable& blocks, ElementNodeTable& nodes);

/// Adds rho V / 4 of each tetrahedron to its nodes. `density` is by tetrahedron [kg/m^3].
void add_lumped_mass(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                     std::span<const Real> density, std::span<Real> mass);

/// Builds the patches, their nodes and the slots of element nodes for the blocks and nodes that have none yet: those of
/// added bodies, or all. The slots of a patch are in the order of its nodes, and those of a node in the order of its
/// patches.
void build_patches(ElementBlockTable& blocks, std::size_t node_count, ElementNodeTable& nodes, ElementPatches& patches);

/// Keeps only the patches of the first blocks and nodes, which must be those of whole bodies.
void truncate_patches(Index block_count, Index node_count, ElementPatches& patches);

}  // namespace skerry
