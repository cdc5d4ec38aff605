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

/// Of a patch: some 10 us of work, well above the cost of handing out a job, and positions and forces of its nodes fit
/// into the first cache.
inline constexpr std::size_t elements_per_patch = 256;

/// m, of one tetrahedron.
Real smallest_altitude(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position);

/// Appends the blocks of a new body's tetrahedra, in the order of the mesh. `tetrahedra` index the body's own nodes;
/// `first_node` is the row of its first node.
Range append_tetrahedra(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                        Index first_node, TetrahedronBlockTable& table);

/// Where the elements of a list go.
struct ElementPlaces {
    std::vector<Index> element;             // block by block; no_index in a lane that is left over
    std::vector<std::uint8_t> opens_patch;  // by block
};

struct AppendedElements {
    Range blocks, nodes;         // rows
    std::vector<Index> element;  // of the list, by place in the blocks; no_index in a lane that is left over
};

/// Elements stand patch after patch: compact groups of up to elements_per_patch in space, found by
/// halving the longest side again and again. Within a patch blocks have elements of one part and one material, those
/// with as many nodes together, so that few rows are left over; otherwise they keep their order.
/// `rest_position`: positions of the body's nodes at rest [m]. Guards have patches of their own, behind the others.
ElementPlaces find_places(const ElementList& list, std::span<const Vec3> rest_position);

/// Appends the elements of a new body at their places, which were found for a list with the same nodes.
AppendedElements append_elements(const ElementList& list, const ElementPlaces& places, Index first_node, Index body,
                                 ElementBlockTable& blocks, ElementNodeTable& nodes);
/// Finds the places of the elements of a new body and appends the elements there.
AppendedElements append_elements(const ElementList& list, std::span<const Vec3> rest_position, Index first_node,
                                 Index body, ElementBlockTable& blocks, ElementNodeTable& nodes);

/// Turns the rest shape of elements: their gradients, and the mass forms that they have.
void turn_elements(const Mat3& rotation, Range rows, ElementBlockTable& blocks, ElementNodeTable& nodes);

/// Adds rho V / 4 of each tetrahedron to its nodes; `density` by tetrahedron, kg/m^3.
void add_lumped_mass(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                     std::span<const Real> density, std::span<Real> mass);

/// Patches, their nodes and the slots of the nodes of elements, for the blocks and nodes behind those that have theirs:
/// of bodies that were added, or of all. Slots of a patch are in the order of its nodes, and a node has its own in that
/// of the patches.
void build_patches(ElementBlockTable& blocks, std::size_t node_count, ElementNodeTable& nodes, ElementPatches& patches);

/// Leaves the patches of the first blocks and nodes, which are those of whole bodies.
void truncate_patches(Index block_count, Index node_count, ElementPatches& patches);

}  // namespace skerry
