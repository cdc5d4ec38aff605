// Finds the material point of a body at a given position.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>

#include "components/types.h"
#include "systems/geometry/material_point.h"

namespace skerry {

/// Returns the corners of the tetrahedron that contains the position `point`, and the barycentric coordinates of this
/// position. If no tetrahedron contains the position, returns the nearest node, or nothing if this node is farther away
/// than `reach` [m]. A body without tetrahedra is rigid: any position moves with it, and is given by coordinates with
/// respect to four of its nodes.
std::optional<MaterialPoint> follow_point(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& point, Real reach);

/// Returns the node nearest to `point`, and its distance from `point` [m].
std::pair<Index, Real> nearest_node(std::span<const Vec3> nodes, const Vec3& point);

}  // namespace skerry
