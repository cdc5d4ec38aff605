// Rest data of the tetrahedra of a new body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/ragged.h"

namespace skerry {

/// Appends the blocks of a new body's tetrahedra. `tetrahedra` index the body's own nodes; `first_node` is the row of
/// its first node. Rest positions must give positive volumes (the scene builder has checked). The rest shape is that of
/// `rest_position` turned by `rotation`, as the body is put into the world: F = I there for every model, the linear one
/// included, and corotational frames start at the identity.
Range append_elements(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                      Index first_node, Index body, Index material, const Mat3& rotation, ElementBlockTable& elements);

/// Adds rho V / 4 of each tetrahedron to its nodes.
void add_lumped_mass(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Vec3> rest_position,
                     Real density, std::span<Real> mass);

/// For every node the corners (4 * element + corner) around it, in element order. Padding lanes are left out.
void build_corners(std::span<const ElementNodes> node, std::span<const ElementLane> volume, std::size_t node_count,
                   Ragged<Index>& corners);

}  // namespace skerry
