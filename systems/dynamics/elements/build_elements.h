// Rows of the tables for the tetrahedra and elements of a new body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/ragged.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// m, of one tetrahedron.
Real smallest_altitude(const std::array<Index, 4>& tetrahedron, std::span<const Vec3> rest_position);

/// Appends the blocks of a new body's tetrahedra, in the order of the mesh. `tetrahedra` index the body's own nodes;
/// `first_node` is the row of its first node.
Range append_tetrahedra(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                        Index first_node, TetrahedronBlockTable& table);

struct AppendedElements {
    Range blocks, nodes;         // rows
    std::vector<Index> element;  // of the list, by place in the blocks; no_index in a lane that is left over
};

/// Appends the elements of a new body. They keep their order but for two things: a block has elements of one part and
/// one material, and among few hundred neighbours of these those with as many nodes stand together, so that few rows
/// are left over.
/// `level` of each element of the list, or none: all 0; elements are sorted by level, and a block has the lowest of its
/// elements.
AppendedElements append_elements(const ElementList& list, std::span<const std::uint8_t> level, Index first_node,
                                 Index body, ElementBlockTable& blocks, ElementNodeTable& nodes);

/// Adds rho V / 4 of each tetrahedron to its nodes; `density` by tetrahedron, kg/m^3.
void add_lumped_mass(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                     std::span<const Real> density, std::span<Real> mass);

/// For every node the places (element_lanes * row + lane) where elements have a force for it, in element order. What is
/// left over is left out.
void build_corners(const ElementBlockTable& blocks, const ElementNodeTable& nodes, std::size_t node_count,
                   Ragged<Index>& corners);

}  // namespace skerry
