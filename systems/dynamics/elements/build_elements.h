// Builds the table rows for the tetrahedra and elements of a new body.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/element_table.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Greatest number of elements in a patch. Computing a full patch takes about 10 us, much longer than starting a job.
/// The positions and forces of the nodes of a patch fit into the L1 cache.
inline constexpr std::size_t elements_per_patch = 256;

/// Smallest altitude of a tetrahedron at rest [m].
Real smallest_altitude(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position);

/// Appends the blocks of the tetrahedra of a new body in mesh order, and returns the range of these blocks.
/// `tetrahedra` holds node numbers within the body; `first_node` is the row of the first node of the body.
Range append_tetrahedra(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                        Index first_node, TetrahedronBlockTable& table);

/// Assignment of the elements of a list to lanes of blocks.
struct ElementPlaces {
    std::vector<Index> element;             // index in the list for each lane; no_index in an unused lane
    std::vector<std::uint8_t> opens_patch;  // 1 if the block is the first of a patch
};

struct AppendedElements {
    Range blocks, nodes;         // appended rows of ElementBlockTable and ElementNodeTable
    std::vector<Index> element;  // index in the list for each lane; no_index in an unused lane
};

/// Assigns the elements of a list to lanes of blocks, patch after patch. A patch is a compact group of up to
/// elements_per_patch neighbouring elements, found by repeatedly halving the body along its longest side.
/// `rest_position`: rest positions of the nodes of the body [m]. Order of the elements:
/// - Inversion barriers (guards) have patches of their own, after all others.
/// - All elements of a block have the same part of the stress (ElementPart) and the same material.
/// - Among these, elements with equal numbers of nodes are adjacent in a patch, so that few rows of a block are unused.
/// - Otherwise elements keep the order of the list.
ElementPlaces find_places(const ElementList& list, std::span<const Vec3> rest_position);

/// Appends the elements of a new body to the tables, in the lanes `places`. `places` may have been found for another
/// list, if its elements have the same nodes, the same parts of the stress and the same division among materials. The
/// nodes of an element are reordered, so that the force kernel seldom adds to a node twice in close succession.
AppendedElements append_elements(const ElementList& list, const ElementPlaces& places, Index first_node, Index body,
                                 ElementBlockTable& blocks, ElementNodeTable& nodes);
/// Assigns the elements of a new body to lanes of blocks, and appends the elements to the tables.
AppendedElements append_elements(const ElementList& list, std::span<const Vec3> rest_position, Index first_node,
                                 Index body, ElementBlockTable& blocks, ElementNodeTable& nodes);

/// Rotates the rest shape of the elements in the blocks `rows`: their gradients, their mass forms
/// (ElementBlockTable::mass_form), and the axes of their materials (`orientation`).
void turn_elements(const Mat3& rotation, Range rows, ElementBlockTable& blocks, ElementNodeTable& nodes);

/// Adds a quarter of the mass of each tetrahedron, rho V / 4, to each of its nodes. `density`: rho by tetrahedron
/// [kg/m^3].
void add_lumped_mass(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                     std::span<const Real> density, std::span<Real> mass);

/// Builds the patches, the lists of their nodes, and the slots of element nodes. A slot is the entry of a patch for one
/// of its nodes. Covers only blocks and nodes that are in no patch yet, and keeps the existing patches of `patches`.
/// The slots of a patch are in the order of its nodes. The slots of a node are in the order of the patches.
void build_patches(ElementBlockTable& blocks, std::size_t node_count, ElementNodeTable& nodes, ElementPatches& patches);

/// Removes all patches except those of the first `block_count` blocks and `node_count` nodes, which must belong to
/// complete bodies.
void truncate_patches(Index block_count, Index node_count, ElementPatches& patches);

}  // namespace skerry
